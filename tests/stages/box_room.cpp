#include "box_room.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "lib/random.h"

namespace hybrid::testing {
namespace {

struct Hit {
  double range = std::numeric_limits<double>::infinity();
  RoomPlane face = kNothing;
};

void nearer(Hit& hit, double range, RoomPlane face) {
  if (range > 1e-6 && range < hit.range) hit = {range, face};
}

// Room walls from inside: where the ray leaves the box, with the face it leaves through (faces: +x -x +y -y
// +z -z).
Hit leave_box(const Vec3& from, const Vec3& to, const Vec3& ray, const RoomPlane (&faces)[6]) {
  Hit hit;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray[axis] > 0) nearer(hit, to[axis] / ray[axis], faces[2 * axis]);
    if (ray[axis] < 0) nearer(hit, from[axis] / ray[axis], faces[2 * axis + 1]);
  }
  return hit;
}

// A solid box from outside.
void hit_box(Hit& hit, const Vec3& from, const Vec3& to, const Vec3& ray, const RoomPlane (&faces)[6]) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  int side = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray[axis] == 0) {
      if (from[axis] > 0 || to[axis] < 0) return;
      continue;
    }
    double a = from[axis] / ray[axis], b = to[axis] / ray[axis];
    const bool positive = ray[axis] > 0;
    if (!positive) std::swap(a, b);
    if (a > enter) {
      enter = a;
      side = 2 * axis + (positive ? 1 : 0);  // a ray going +x meets the -x face
    }
    leave = std::min(leave, b);
  }
  if (enter > 0 && enter < leave) nearer(hit, enter, faces[side]);
}

constexpr double kEast = 3.4, kWest = -2.6, kNorth = 2.3, kSouth = -2.9, kTop = 1.35, kBottom = -1.6;

Hit cast(const BoxRoom& room, const Vec3& ray) {
  Hit hit = leave_box({kWest, kSouth, kBottom}, {kEast, kNorth, kTop}, ray,
                      {kWallEast, kWallWest, kWallNorth, kWallSouth, kCeiling, kFloor});
  if (room.niche_m > 0 && hit.face == kWallSouth) {
    const Vec3 at = hit.range * ray;
    const Vec3 from(-0.7, kSouth - room.niche_m, -0.9), to(0.8, kNorth, 0.6);
    if (at.x() > from.x() && at.x() < to.x() && at.z() > from.z() && at.z() < to.z())
      hit = leave_box(from, to, ray,
                      {kSmallFaces, kSmallFaces, kSmallFaces, kNicheBack, kSmallFaces, kSmallFaces});
  }
  const RoomPlane panel[6] = {kSmallFaces, kPanel, kSmallFaces, kSmallFaces, kSmallFaces, kSmallFaces};
  const double gap = room.panel_gap_m / 2;
  if (room.panel_m > 0) {
    hit_box(hit, {kEast - room.panel_m, -1.0, -0.8}, {kEast + 1, -gap, 0.7}, ray, panel);
    hit_box(hit, {kEast - room.panel_m, gap, -0.8}, {kEast + 1, 0.9, 0.7}, ray, panel);
  }
  if (room.occluder)
    hit_box(hit, {0.2, 1.2, kBottom - 1}, {0.45, 1.3, kTop + 1}, ray,
            {kSmallFaces, kSmallFaces, kSmallFaces, kSmallFaces, kSmallFaces, kSmallFaces});
  if (room.column_radius_m > 0) {
    const Vec2 centre(-1.5, 1.1), direction = ray.head<2>();
    const double a = direction.squaredNorm(), b = direction.dot(centre);
    const double root = b * b - a * (centre.squaredNorm() - room.column_radius_m * room.column_radius_m);
    if (root > 0) nearer(hit, (b - std::sqrt(root)) / a, kColumn);
  }
  return hit;
}

// Least-squares plane over the chosen samples of a square; record.inliers etc. are filled.
void refit(const std::vector<Vec3>& points, SquareRecord& record) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter);
  Vec3 normal = solver.eigenvectors().col(0);
  if (normal.dot(mean) > 0) normal = -normal;
  for (int k = 0; k < 3; ++k) {
    record.normal[k] = static_cast<float>(normal[k]);
    record.centroid[k] = static_cast<float>(mean[k]);
  }
  record.offset = static_cast<float>(normal.dot(mean));
  const int upper[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  for (int k = 0; k < 6; ++k) record.scatter[k] = static_cast<float>(scatter(upper[k][0], upper[k][1]));
  const double rms = std::sqrt(std::max(solver.eigenvalues()[0], 0.0) / static_cast<double>(points.size()));
  record.rms = static_cast<float>(rms);
  record.sigma_normal = static_cast<float>(std::max(rms, 1e-6) / std::sqrt(solver.eigenvalues()[1]));
  record.inliers = static_cast<std::uint32_t>(points.size());
}

std::vector<Vec3> near_plane(const std::vector<Vec3>& points, const Vec3& normal, double offset,
                             double sigma) {
  std::vector<Vec3> kept;
  for (const Vec3& p : points)
    if (std::abs(normal.dot(p) - offset) <=
        (3 * sigma + 0.002) * std::max(std::abs(normal.dot(p)) / p.norm(), 0.05))
      kept.push_back(p);
  return kept;
}

SquareRecord fit_square(const std::vector<Vec3>& points, int nodes, double sigma, std::uint32_t id) {
  SquareRecord record{};
  record.valid = static_cast<std::uint32_t>(points.size());
  if (static_cast<double>(points.size()) < 0.7 * nodes || points.size() < 3) return record;
  record.state = SQUARE_NON_PLANAR;
  std::vector<Vec3> best;
  for (std::uint32_t k = 0; k < 32; ++k) {
    const auto pick = [&](std::uint32_t draw) { return points[random_below(7 + k, id, draw, record.valid)]; };
    const Vec3 a = pick(0);
    const Vec3 normal = (pick(1) - a).cross(pick(2) - a);
    if (!(normal.norm() > 1e-12)) continue;
    const auto inliers = near_plane(points, normal.normalized(), normal.normalized().dot(a), sigma);
    if (inliers.size() > best.size()) best = inliers;
  }
  if (best.size() < 3 || static_cast<double>(best.size()) < 0.8 * static_cast<double>(points.size()))
    return record;
  record.state = SQUARE_PLANAR;
  refit(best, record);
  return record;
}

}  // namespace

RoomScore score_room(const RoomScan& scan, const PlaneSegmentation& segmentation) {
  using Counts = std::array<std::int64_t, 16>;
  std::vector<Counts> votes(segmentation.superclusters.size() + 1);
  for (std::size_t i = 0; i < scan.truth.size(); ++i)
    if (scan.image.mask[i] == kMeasured) votes[segmentation.sample_label[i]][scan.truth[i]] += 1;
  RoomScore result;
  Counts total{}, right{};
  for (std::size_t k = 0; k < votes.size(); ++k) {
    const auto most =
        static_cast<std::size_t>(std::max_element(votes[k].begin(), votes[k].end()) - votes[k].begin());
    if (k > 0) result.majority.push_back(most);
    if (k > 0) right[most] += votes[k][most];
    for (std::size_t t = 0; t < total.size(); ++t) total[t] += votes[k][t];
  }
  std::int64_t all = 0, all_right = 0;
  for (std::size_t face = 1; face <= kScoredPlanes; ++face) {
    all += total[face];
    all_right += right[face];
    result.found += total[face] > 0 && 2 * right[face] >= total[face];
  }
  result.right = static_cast<double>(all_right) / static_cast<double>(all);
  if (total[kColumn] > 0)
    result.curved_planar = 1 - static_cast<double>(votes[0][kColumn]) / static_cast<double>(total[kColumn]);
  return result;
}

RoomScan scan_room(const BoxRoom& room) {
  RoomScan scan;
  RangeImage& image = scan.image;
  image = make_range_image(room.rows, room.cols);
  image.wraps = room.full_turn;
  scan.truth.assign(image.count(), kNothing);
  const double degree = std::numbers::pi / 180;
  for (int row = 0; row < room.rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] =
        degree * (room.highest_deg - (room.highest_deg - room.lowest_deg) * row / std::max(room.rows - 1, 1));
  for (int col = 0; col < room.cols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] =
        degree * (room.full_turn ? -180 + 360.0 * col / room.cols : -140 + 100.0 * col / room.cols);
  std::mt19937 random(room.seed);
  std::normal_distribution<double> noise(0, 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t i = 0; i < image.count(); ++i) {
    const double stray = room.jitter * (2 * uniform(random) - 1),
                 sideways = room.jitter * (2 * uniform(random) - 1);
    const double el =
        image.elevation_rad[i / static_cast<std::size_t>(room.cols)] + stray * image.elevation_step_rad();
    const double az =
        image.azimuth_rad[i % static_cast<std::size_t>(room.cols)] + sideways * image.azimuth_step_rad();
    const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
    const Hit hit = cast(room, room.turned * ray);
    const double range = hit.range + room.noise_m * noise(random);
    if (uniform(random) < room.dropouts) continue;
    const Vec3 point = range * ray;
    image.range_m[i] = static_cast<float>(range);
    image.x[i] = static_cast<float>(point.x());
    image.y[i] = static_cast<float>(point.y());
    image.z[i] = static_cast<float>(point.z());
    image.mask[i] = kMeasured;
    image.source[i] = static_cast<std::uint32_t>(i);
    scan.truth[i] = hit.face;
  }
  return scan;
}

stages::SquarePlanes fit_squares(const RangeImage& image, int square, double sigma_m) {
  stages::SquarePlanes result;
  result.square = square;
  result.rows = (image.rows + square - 1) / square;
  result.cols = (image.cols + square - 1) / square;
  result.sigma_m = sigma_m;
  result.noise = {sigma_m};
  for (int row = 0; row < result.rows; ++row)
    for (int col = 0; col < result.cols; ++col) {
      std::vector<Vec3> points;
      int nodes = 0;
      for (int r = row * square; r < std::min((row + 1) * square, image.rows); ++r)
        for (int c = col * square; c < std::min((col + 1) * square, image.cols); ++c, ++nodes)
          if (image.mask[image.index(r, c)] != kEmpty) points.push_back(image.point(image.index(r, c)));
      result.squares.push_back(
          fit_square(points, nodes, sigma_m, static_cast<std::uint32_t>(result.squares.size())));
    }
  return result;
}

}  // namespace hybrid::testing
