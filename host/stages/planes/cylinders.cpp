#include "stages/planes/cylinders.hpp"

#include <algorithm>
#include <array>

#include "core/parallel.hpp"
#include "core/parallel_tasks.hpp"
#include "stages/planes/cylinder_search.hpp"
#include "stages/planes/plane_regions.hpp"
#include "stages/planes/strip_planes.hpp"

namespace hybrid::stages {
namespace {

constexpr double kUneven = 0.02;  // of the radius

bool holds(const Cylinder& cylinder, const Vec3& point, double reach_m) {
  const double along = cylinder.along(point);
  return along >= 0 && along <= cylinder.length_m && std::abs(cylinder.distance(point)) <= reach_m;
}

// Pipes that are narrower than a few squares, on strips of these that no known cylinder holds.
std::vector<Cylinder> on_strips(const RangeImage& image, const SquarePlanes& squares,
                                const std::vector<std::uint32_t>& labels, const std::vector<Cylinder>& known,
                                int height, int width, const SuperclusterOptions& options) {
  const SquarePlanes strips = fit_strips(image, labels, squares, height, width);
  std::vector<std::uint8_t> free(strips.squares.size());
  parallel_for(
      free.size(),
      [&](std::size_t i) {
        const SquareRecord& strip = strips.squares[i];
        free[i] = strip.state == SQUARE_PLANAR &&
                  std::none_of(known.begin(), known.end(), [&](const Cylinder& cylinder) {
                    const Vec3 centroid = square_centroid(strip);
                    return holds(cylinder, centroid,
                                 2 * cylinder_reach_m(cylinder, centroid, strips.noise, options));
                  });
      },
      1 << 10);
  return search_cylinders(image, {strips, height, width, std::move(free)}, labels, options, false);
}

}  // namespace

double cylinder_reach_m(const Cylinder& cylinder, const Vec3& point, const RangeNoise& noise,
                        const SuperclusterOptions& options) {
  const double range = point.norm(), radius = cylinder.outwards(point).norm();
  const double cosine = std::abs(cylinder.outwards(point).dot(point)) / std::max(range * radius, 1e-12);
  return options.label_sigmas * noise.at(range, cosine) * cosine + cylinder_unevenness_m(cylinder, options);
}

double cylinder_unevenness_m(const Cylinder& cylinder, const SuperclusterOptions& options) {
  return std::min(options.waviness_m, kUneven * cylinder.radius_m);
}

std::vector<Cylinder> find_cylinders(const RangeImage& image, const SquarePlanes& squares,
                                     const PlaneSegmentation& segmentation,
                                     const SuperclusterOptions& options) {
  if (options.min_cylinder_samples <= 0 || image.count() == 0) return {};
  const auto& labels = segmentation.sample_label;
  const int n = squares.square;
  std::vector<std::uint8_t> free(squares.squares.size());
  for (std::size_t i = 0; i < free.size(); ++i)
    free[i] = squares.squares[i].state == SQUARE_PLANAR && segmentation.square_label[i] == 0;
  std::array<std::vector<Cylinder>, 2> sides;
  run_tasks({[&] {
               sides[0] = search_cylinders(image, {squares, n, n, free}, labels, options, false);
             },
             [&] {
               sides[1] = search_cylinders(image, {squares, n, n, free}, labels, options, true);
             }});
  std::vector<Cylinder> found = std::move(sides[0]);
  found.insert(found.end(), sides[1].begin(), sides[1].end());
  const auto known = found;
  std::array<std::vector<Cylinder>, 2> narrow;  // upright ones, level ones
  const int side = std::max(3, n / 3);
  run_tasks({[&] { narrow[0] = on_strips(image, squares, labels, known, n, side, options); },
             [&] { narrow[1] = on_strips(image, squares, labels, known, side, n, options); }});
  for (const auto& those : narrow)
    for (const Cylinder& one : those)
      if (std::none_of(found.begin(), found.end(),
                       [&](const Cylinder& other) { return is_same(one, other); }))
        found.push_back(one);
  std::stable_sort(found.begin(), found.end(),
                   [](const Cylinder& a, const Cylinder& b) { return a.samples > b.samples; });
  for (std::size_t i = 0; i < found.size(); ++i) found[i].id = static_cast<std::uint32_t>(i + 1);
  return found;
}

}  // namespace hybrid::stages
