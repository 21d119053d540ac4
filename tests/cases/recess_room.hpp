#pragma once
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "cases/closest_point_case.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "lib/random.h"

namespace hybrid::testing {

// A scan of a room of 8 x 6 x 3 m with two recesses, ray by ray, with known pose and planes. The proxy is the
// room without them. Labels are the truth, planes are fitted to the noisy samples.
struct RecessRoomScan {
  RangeImage image;
  PlaneSegmentation segmentation;
  PolygonModel proxy;
  Pose world_from_scan;
};

// An axis-parallel rectangle: coordinate `axis` = value, the other two (in cyclic order) within low .. high.
struct RoomRectangle {
  int axis;
  double value;
  std::array<double, 2> low, high;
};

inline std::vector<RoomRectangle> room_rectangles() {
  std::vector<RoomRectangle> walls;
  const double size[3] = {8, 6, 3};
  for (int axis = 0; axis < 3; ++axis)
    for (double value : {0.0, size[axis]})
      walls.push_back({axis, value, {0, 0}, {size[(axis + 1) % 3], size[(axis + 2) % 3]}});
  // A doorway 40 cm deep in the wall x = 8 (y 1..3, z 0..2.2), a window 25 cm deep in y = 6 (z 0.8..2.2, x
  // 2..5): back, then the four sides.
  walls.push_back({0, 8.4, {1, 0}, {3, 2.2}});
  walls.push_back({1, 1, {0, 8}, {2.2, 8.4}});
  walls.push_back({1, 3, {0, 8}, {2.2, 8.4}});
  walls.push_back({2, 0, {8, 1}, {8.4, 3}});
  walls.push_back({2, 2.2, {8, 1}, {8.4, 3}});
  walls.push_back({1, 6.25, {0.8, 2}, {2.2, 5}});
  walls.push_back({2, 0.8, {2, 6}, {5, 6.25}});
  walls.push_back({2, 2.2, {2, 6}, {5, 6.25}});
  walls.push_back({0, 2, {6, 0.8}, {6.25, 2.2}});
  walls.push_back({0, 5, {6, 0.8}, {6.25, 2.2}});
  return walls;
}

inline bool in_room_opening(int wall, const Vec3& p) {
  if (wall == 1) return p.y() > 1 && p.y() < 3 && p.z() < 2.2;
  if (wall == 3) return p.x() > 2 && p.x() < 5 && p.z() > 0.8 && p.z() < 2.2;
  return false;
}

// Range along the ray and index of the rectangle it meets first; -1 for none.
inline std::pair<double, int> cast_room_ray(const std::vector<RoomRectangle>& walls, const Vec3& eye,
                                            const Vec3& ray) {
  std::pair<double, int> best{INFINITY, -1};
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const auto& wall = walls[w];
    const double range = (wall.value - eye(wall.axis)) / ray(wall.axis);
    if (!(range > 0 && range < best.first)) continue;
    const Vec3 p = eye + range * ray;
    const double u = p((wall.axis + 1) % 3), v = p((wall.axis + 2) % 3);
    if (u < wall.low[0] || u > wall.high[0] || v < wall.low[1] || v > wall.high[1]) continue;
    if (!in_room_opening(static_cast<int>(w), p)) best = {range, static_cast<int>(w)};
  }
  return best;
}

// Least-squares plane of the label's samples, towards the scanner.
inline Plane fit_label(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                       std::uint32_t label) {
  double count = 0;
  Vec3 centroid = Vec3::Zero();
  Mat3 scatter = Mat3::Zero();
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == label) {
      count += 1;
      centroid += image.point(i);
      scatter += image.point(i) * image.point(i).transpose();
    }
  centroid /= count;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter / count - centroid * centroid.transpose());
  Vec3 normal = solver.eigenvectors().col(0);
  if (normal.dot(centroid) > 0) normal = -normal;
  return {normal, normal.dot(centroid)};
}

// Superclusters in the order in which their walls are met.
inline void label_walls(RecessRoomScan& scan, const std::vector<int>& hit, const std::vector<int>& hits,
                        int min_samples) {
  std::vector<std::uint32_t> label_of(hits.size(), 0);
  scan.segmentation.sample_label.assign(hit.size(), 0);
  for (std::size_t i = 0; i < hit.size(); ++i) {
    if (hit[i] < 0 || hits[static_cast<std::size_t>(hit[i])] < min_samples) continue;
    auto& label = label_of[static_cast<std::size_t>(hit[i])];
    if (label == 0) {
      label = static_cast<std::uint32_t>(scan.segmentation.superclusters.size() + 1);
      scan.segmentation.superclusters.push_back({});
      scan.segmentation.superclusters.back().id = label;
    }
    scan.segmentation.sample_label[i] = label;
    ++scan.segmentation.superclusters[label - 1].samples;
  }
}

// `only`: rectangles that return samples (empty = all); the others are glass. Walls with fewer than
// `min_samples` get no label.
inline RecessRoomScan scan_recess_room(int rows, int cols, double noise_m,
                                       const Vec3& world_shift = Vec3::Zero(),
                                       const std::vector<int>& only = {}, int min_samples = 60) {
  RecessRoomScan scan;
  const auto walls = room_rectangles();
  const Vec3 eye(3.1, 2.4, 1.6);
  scan.world_from_scan.rotation =
      Eigen::AngleAxisd(0.6, Vec3::UnitZ()) * Eigen::AngleAxisd(0.01, Vec3(1, 2, 0).normalized());
  scan.world_from_scan.translation = eye + world_shift;
  scan.image = make_range_image(rows, cols);
  auto& image = scan.image;
  image.wraps = true;
  const double pi = std::numbers::pi;
  for (int row = 0; row < rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = pi / 2 - pi * (row + 0.5) / rows * 0.9;
  for (int col = 0; col < cols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = -pi + 2 * pi * (col + 0.5) / cols;
  std::vector<int> hit(image.count(), -1), hits(walls.size());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const std::size_t i = image.index(row, col);
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const auto [range, wall] = cast_room_ray(walls, eye, scan.world_from_scan.rotate(ray));
      if (wall < 0 || (!only.empty() && std::find(only.begin(), only.end(), wall) == only.end())) continue;
      const auto id = static_cast<std::uint32_t>(i);
      const double u1 = (random_bits(9, id, 0) + 0.5) / 4294967296.0,
                   u2 = random_bits(9, id, 1) / 4294967296.0;
      const double measured = range + noise_m * std::sqrt(-2 * std::log(u1)) * std::cos(2 * pi * u2);
      const Vec3f p = (measured * ray).cast<float>();
      image.range_m[i] = static_cast<float>(measured);
      image.x[i] = p.x();
      image.y[i] = p.y();
      image.z[i] = p.z();
      image.mask[i] = kMeasured;
      image.source[i] = id;
      hit[i] = wall;
      ++hits[static_cast<std::size_t>(wall)];
    }
  label_walls(scan, hit, hits, min_samples);
  for (auto& cluster : scan.segmentation.superclusters)
    cluster.plane = fit_label(image, scan.segmentation.sample_label, cluster.id);
  add_box(scan.proxy, world_shift, world_shift + Vec3(8, 6, 3), 0, true);
  return scan;
}

// The pose moved by this much in random directions: rotation about the scanner.
inline Pose disturbed(const Pose& pose, double distance_m, double angle_deg, std::uint32_t trial) {
  auto direction = [&](std::uint32_t draw) -> Vec3 {
    for (std::uint32_t k = draw;; k += 3) {
      const Vec3 v(random_bits(77, trial, k) / 2147483648.0 - 1,
                   random_bits(77, trial, k + 1) / 2147483648.0 - 1,
                   random_bits(77, trial, k + 2) / 2147483648.0 - 1);
      if (v.norm() < 1 && v.norm() > 0.1) return v.normalized();
    }
  };
  Pose start = pose;
  start.rotation = Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180, direction(0)) * pose.rotation;
  start.translation += distance_m * direction(1000);
  return start;
}

}  // namespace hybrid::testing
