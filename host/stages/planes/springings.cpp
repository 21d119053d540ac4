#include "stages/planes/springings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/parallel.hpp"
#include "stages/planes/cylinders.hpp"
#include "stages/planes/sample_labels.hpp"

namespace hybrid::stages {
namespace {

constexpr double kMostTilt = 2 * std::numbers::pi / 180;  // of the axis out of the plane
constexpr double kLookedAt = 3;       // times the width in which plane and cylinder are one
constexpr double kMostBeyond = 0.05;  // of the samples before the line: a plane with more goes on beyond it
constexpr std::int64_t kFewest = 48;  // samples on either side
constexpr int kManyRows = 1000;       // more are looked at with a stride
constexpr std::int64_t kOneOf = 50;   // a plane that lost one sample in so many is fitted again

// Where a cylinder touches a plane.
struct Springing {
  const Cylinder* cylinder;
  std::uint32_t plane;  // id
  Plane wall;
  Vec3 across;      // unit, on the plane, perpendicular to the axis
  double width_m;   // from the line: there the cylinder leaves the plane by more than it may stray
  double reach_m;   // how far samples may stray from either
  double side = 0;  // of `across`, on which the cylinder goes on; 0: on none or on both

  // Metres from the line, along `across`.
  double beyond(const Vec3& point) const { return across.dot(point - cylinder->foot); }
  bool is_near(const Vec3& point) const {
    const double along = cylinder->along(point);
    return along >= -kVaultGoesOn_m && along <= cylinder->length_m + kVaultGoesOn_m &&
           std::abs(beyond(point)) <= kLookedAt * width_m;
  }
};

std::vector<Springing> touching(const RangeNoise& noise, const SuperclusterOptions& options,
                                const PlaneSegmentation& segmentation) {
  std::vector<Springing> found;
  for (const Cylinder& cylinder : segmentation.cylinders)
    for (const Supercluster& plane : segmentation.superclusters) {
      const Plane& wall = plane.plane;
      if (!cylinder.inside || std::abs(wall.normal.dot(cylinder.axis)) > std::sin(kMostTilt)) continue;
      const double half = 0.5 * cylinder.length_m,
                   height = wall.distance(cylinder.foot + half * cylinder.axis);
      const Vec3 outwards = (height < 0 ? 1 : -1) * wall.normal;
      const Vec3 touch = cylinder.foot + half * cylinder.axis + cylinder.radius_m * outwards;
      const double reach = cylinder_reach_m(cylinder, touch, noise, options);
      // Its ends, too: the axis is parallel to the plane.
      const double lean = half * std::abs(wall.normal.dot(cylinder.axis));
      if (std::abs(std::abs(height) - cylinder.radius_m) + lean > reach) continue;
      found.push_back({&cylinder, plane.id, wall, wall.normal.cross(cylinder.axis).normalized(),
                       std::sqrt(2 * cylinder.radius_m * reach), reach});
    }
  return found;
}

// Samples beside a line where plane and cylinder are apart, per side of it.
struct Sides {
  std::array<std::int64_t, 2> of_plane{}, of_cylinder{};
};

// Which side the cylinder is on: it goes on there and the plane does not; before the line it is the reverse.
double side_of(const Sides& counts) {
  for (const std::size_t side : {0u, 1u}) {
    const auto plane = counts.of_plane, cylinder = counts.of_cylinder;
    const std::size_t before = 1 - side;
    const auto few = [](std::int64_t some, std::int64_t many) {
      return static_cast<double>(some) <= kMostBeyond * static_cast<double>(many);
    };
    if (plane[before] >= kFewest && cylinder[side] >= kFewest && few(plane[side], plane[before]) &&
        few(cylinder[before], cylinder[side]))
      return side == 0 ? -1 : 1;
  }
  return 0;
}

void find_sides(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                std::vector<Springing>& springings) {
  const int stride = 1 + image.rows / kManyRows, rows = (image.rows + stride - 1) / stride;
  std::vector<std::vector<Sides>> counts(static_cast<std::size_t>(rows),
                                         std::vector<Sides>(springings.size()));
  parallel_for(counts.size(), [&](std::size_t r) {
    for (int col = 0; col < image.cols; col += stride) {
      const std::size_t i = image.index(static_cast<int>(r) * stride, col);
      if (image.mask[i] != kMeasured) continue;
      const Vec3 point = image.point(i);
      for (std::size_t s = 0; s < springings.size(); ++s) {
        const Springing& at = springings[s];
        if ((labels[i] != 0 && labels[i] != at.plane) || !at.is_near(point)) continue;
        const double beyond = at.beyond(point);
        if (std::abs(beyond) < at.width_m) continue;
        if (labels[i] == 0 && (std::abs(at.cylinder->distance(point)) > at.reach_m ||
                               std::abs(at.wall.distance(point)) > kLookedAt * kLookedAt * at.reach_m))
          continue;
        auto& side = labels[i] == 0 ? counts[r][s].of_cylinder : counts[r][s].of_plane;
        ++side[beyond > 0];
      }
    }
  });
  for (std::size_t s = 0; s < springings.size(); ++s) {
    Sides all;
    for (const auto& row : counts)
      for (const std::size_t side : {0u, 1u}) {
        all.of_plane[side] += row[s].of_plane[side] * stride * stride;
        all.of_cylinder[side] += row[s].of_cylinder[side] * stride * stride;
      }
    springings[s].side = side_of(all);
  }
  std::erase_if(springings, [](const Springing& at) { return at.side == 0; });
}

// Samples that each springing takes from its plane; labels change.
std::vector<std::int64_t> take(const RangeImage& image, const RangeNoise& noise,
                               const SuperclusterOptions& options, const std::vector<Springing>& springings,
                               std::vector<std::uint32_t>& labels) {
  std::vector<std::vector<std::size_t>> of_plane(1);
  for (std::size_t s = 0; s < springings.size(); ++s) {
    if (springings[s].plane >= of_plane.size()) of_plane.resize(springings[s].plane + 1);
    of_plane[springings[s].plane].push_back(s);
  }
  std::vector<std::vector<std::int64_t>> taken(static_cast<std::size_t>(image.rows));
  parallel_for(taken.size(), [&](std::size_t row) {
    taken[row].resize(springings.size());
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(static_cast<int>(row), col);
      if (labels[i] == 0 || labels[i] >= of_plane.size() || image.mask[i] == kEmpty) continue;
      for (const std::size_t s : of_plane[labels[i]]) {
        const Springing& at = springings[s];
        const Vec3 point = image.point(i);
        if (!at.is_near(point) || !(at.side * at.beyond(point) > 0) ||
            std::abs(at.cylinder->distance(point)) > cylinder_reach_m(*at.cylinder, point, noise, options))
          continue;
        labels[i] = 0;
        taken[row][s] += image.mask[i] == kMeasured;
        break;
      }
    }
  });
  std::vector<std::int64_t> all(springings.size());
  for (const auto& row : taken)
    for (std::size_t s = 0; s < all.size(); ++s) all[s] += row[s];
  return all;
}

}  // namespace

void trim_springings(const RangeImage& image, const RangeNoise& noise, const SuperclusterOptions& options,
                     PlaneSegmentation& segmentation) {
  auto springings = touching(noise, options, segmentation);
  if (springings.empty()) return;
  auto& labels = segmentation.sample_label;
  auto& planes = segmentation.superclusters;
  find_sides(image, labels, springings);
  const auto taken = take(image, noise, options, springings, labels);
  std::vector<std::int64_t> lost(planes.size());
  for (std::size_t s = 0; s < springings.size(); ++s) {
    lost[springings[s].plane - 1] += taken[s];
    segmentation.cylinders[springings[s].cylinder->id - 1].samples += taken[s];
  }
  std::vector<std::uint32_t> much;
  std::vector<Plane> fitted;
  for (const Supercluster& plane : planes) {
    fitted.push_back(plane.plane);
    if (kOneOf * lost[plane.id - 1] > plane.samples) much.push_back(plane.id);
  }
  if (!much.empty())
    polish_planes(image, segmentation.square, labels, noise, fitted, PolishRounds::last, much);
  const auto measured = measure_planes(image, segmentation.square, labels, fitted);
  for (Supercluster& plane : planes) {
    if (lost[plane.id - 1] == 0) continue;
    const Supercluster& now = measured[plane.id - 1];
    plane.plane = now.plane;
    plane.centroid_m = now.centroid_m;
    plane.rms_m = now.rms_m;
    plane.area_m2 = now.area_m2;
    plane.samples = now.samples;
  }
}

}  // namespace hybrid::stages
