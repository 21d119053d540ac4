#include "stages/rendering/photograph_levels.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "shared/records.h"

namespace hybrid::stages {
namespace {

constexpr int kGrid = 128;         // rays along the view's longer side
constexpr double kAliased = 0.02;  // share of a view's pixels that may find their photograph too coarse
constexpr int kMostLevels = 6;
constexpr double kLeastCosine = 0.05;  // as in kernels/rank_photos.cl

struct GridPoint {
  Vec3 position, normal;  // local frame
  double radius;
};

// Where a grid of the view's rays meets what is shown.
std::vector<GridPoint> grid_points(RenderState& state, const DeviceBvh& shown, const Photograph& view) {
  Photograph grid = view;
  Camera& c = grid.camera;
  const double factor = std::max(1.0, std::max(c.width, c.height) / static_cast<double>(kGrid));
  c.width = std::max(1, static_cast<int>(c.width / factor));
  c.height = std::max(1, static_cast<int>(c.height / factor));
  c.fx /= factor, c.cx /= factor;
  c.fy /= factor, c.cy /= factor;
  SurfaceTile tile(state.queue, static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height));
  cast_tile(state.queue, shown, camera_record(grid, state.origin), {0, 0, c.height, c.width}, {0.5f, 0.5f},
            state.options.surface_tolerance_m, tile);
  const std::vector<float> surface = state.queue.read(tile.surface);
  const std::size_t count = tile.count();
  std::vector<GridPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto plane = [&](std::size_t p) { return static_cast<double>(surface[p * count + i]); };
    if (std::isnan(plane(SURFACE_X))) continue;
    points.push_back({{plane(SURFACE_X), plane(SURFACE_Y), plane(SURFACE_Z)},
                      {plane(SURFACE_NORMAL_X), plane(SURFACE_NORMAL_Y), plane(SURFACE_NORMAL_Z)},
                      plane(SURFACE_RADIUS)});
  }
  return points;
}

// Length on the surface that a pixel covers, as rank_photos has it; 0 where the cosine of sight and normal is
// no more than `least_facing`.
double footprint_m(const GridPoint& point, const Vec3& from, double pixel_rad, double least_facing) {
  const Vec3 ray = point.position - from;
  const double facing = point.radius < 0 ? 1.0 : -point.normal.dot(ray) / ray.norm();
  if (facing <= least_facing) return 0;
  return pixel_rad * ray.norm() / std::max(std::abs(facing), kLeastCosine);
}

int level_of(std::vector<double>& ratios) {
  if (ratios.empty()) return 0;
  const auto at =
      ratios.begin() + static_cast<std::ptrdiff_t>(kAliased * static_cast<double>(ratios.size() - 1));
  std::nth_element(ratios.begin(), at, ratios.end());
  return std::clamp(static_cast<int>(std::floor(std::log2(*at))), 0, kMostLevels);
}

}  // namespace

std::vector<int> photograph_levels(RenderState& state, const DeviceBvh& shown, const Photograph& view) {
  std::vector<int> levels(state.scene.photographs.size(), 0);
  if (!state.options.levels || levels.empty()) return levels;
  const std::vector<GridPoint> points = grid_points(state, shown, view);
  const Vec3 eye = view.centre() - state.origin;
  const double view_rad =
      static_cast<double>(pixel_angle_rad(view.camera)) / std::max(1, state.options.samples_per_axis);
  constexpr double kBothSides = -2;  // a view sees faces from behind, too
  const double least = static_cast<double>(least_facing(state.options));
  parallel_for(levels.size(), [&](std::size_t p) {
    if (state.store.masked(p)) return;
    const Photograph& photograph = state.scene.photographs[p];
    const Vec3 centre = photograph.centre() - state.origin;
    const auto pixel_rad = static_cast<double>(state.store.pixel_rad(p));
    std::vector<double> ratios;
    for (const GridPoint& point : points) {
      if (!photograph.camera.project(photograph.cam_from_world * Vec3(point.position + state.origin)))
        continue;
      const double its = footprint_m(point, centre, pixel_rad, least);
      if (its > 0) ratios.push_back(footprint_m(point, eye, view_rad, kBothSides) / its);
    }
    levels[p] = level_of(ratios);
  });
  return levels;
}

Image8 half_size(const Image8& image) {
  const auto& linear = linear_of_bytes<float>();
  Image8 half((image.width + 1) / 2, (image.height + 1) / 2, 3);
  parallel_for(static_cast<std::size_t>(half.height), [&](std::size_t row) {
    const int y = static_cast<int>(row), top = 2 * y, bottom = std::min(top + 1, image.height - 1);
    for (int x = 0; x < half.width; ++x) {
      const int left = 2 * x, right = std::min(left + 1, image.width - 1);
      for (int k = 0; k < 3; ++k) {
        const float sum = linear[image.at(left, top)[k]] + linear[image.at(right, top)[k]] +
                          linear[image.at(left, bottom)[k]] + linear[image.at(right, bottom)[k]];
        half.at(x, y)[k] = srgb_byte_from_linear(0.25f * sum);
      }
    }
  });
  return half;
}

Camera half_camera(Camera camera, int levels) {
  for (int level = 0; level < levels; ++level) {
    camera.width = (camera.width + 1) / 2;
    camera.height = (camera.height + 1) / 2;
    camera.fx /= 2, camera.cx /= 2;
    camera.fy /= 2, camera.cy /= 2;
  }
  return camera;
}

}  // namespace hybrid::stages
