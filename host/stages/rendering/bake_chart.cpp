#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "stages/rendering/photo_blend.hpp"
#include "stages/rendering/render_state.hpp"

namespace hybrid::stages {
namespace {

// From this many diagonals of the scene away, the rays to all texels of a chart are its normal, to 20 seconds
// of arc.
constexpr double kFar = 1e4;

// The tile's texels as surface points of the local frame, in the layout of kernels/ray_cast.cl.
std::vector<float> tile_surface(const AtlasChart& chart, const std::vector<std::uint8_t>& mask,
                                const Vec3& origin, const Tile& tile) {
  const std::size_t count = static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.cols);
  std::vector<float> planes(SURFACE_PLANES * count, std::numeric_limits<float>::quiet_NaN());
  const Vec3f normal = chart.normal.cast<float>();
  parallel_for(static_cast<std::size_t>(tile.rows), [&](std::size_t tile_row) {
    const std::size_t row = static_cast<std::size_t>(tile.row) + tile_row;
    for (std::size_t tile_col = 0; tile_col < static_cast<std::size_t>(tile.cols); ++tile_col) {
      const std::size_t col = static_cast<std::size_t>(tile.col) + tile_col;
      if (!mask[row * static_cast<std::size_t>(chart.cols) + col]) continue;
      const std::size_t to = tile_row * static_cast<std::size_t>(tile.cols) + tile_col;
      const Vec3 world = chart.point(static_cast<double>(col) + 0.5, static_cast<double>(row) + 0.5);
      const Vec3f point = (world - origin).cast<float>();
      for (std::size_t k = 0; k < 3; ++k) {
        planes[(SURFACE_X + k) * count + to] = point[static_cast<int>(k)];
        planes[(SURFACE_NORMAL_X + k) * count + to] = normal[static_cast<int>(k)];
      }
      planes[SURFACE_RADIUS * count + to] = chart.contour ? kContourRadius_m : 0.0f;
    }
  });
  return planes;
}

// The photographs before the chart's plane whose field of view it meets: no other sees a texel of it. Most
// charts of a model of many faces are behind most photographs.
std::vector<std::size_t> photographs_towards(const AtlasChart& chart, const std::vector<SightCone>& sights) {
  constexpr double kRounding_m = 0.01;
  const Vec3 middle = chart.point(0.5 * chart.cols, 0.5 * chart.rows);
  const double radius_m = 0.5 * chart.texel_m * std::hypot(chart.cols, chart.rows);
  std::vector<std::size_t> towards;
  for (std::size_t i = 0; i < sights.size(); ++i)
    if (chart.normal.dot(sights[i].apex - middle) > -kRounding_m &&
        sights[i].meets_ball(middle, radius_m + kRounding_m))
      towards.push_back(i);
  return towards;
}

void fill_unseen(const std::vector<std::uint8_t>& mask, std::vector<float>& colour) {
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i]) colour[3 * i] = 1.0f;
}

}  // namespace

Renderer::BakedChart Renderer::bake(const AtlasChart& chart, const std::vector<std::uint8_t>& mask) {
  RenderState& s = *state_;
  const auto cols = static_cast<std::size_t>(chart.cols);
  BakedChart out;
  out.colour.assign(3 * mask.size(), 0.0f);
  out.coverage.assign(mask.size(), 0);
  out.best.assign(mask.size(), -1);
  const std::vector<std::size_t> used = photographs_towards(chart, s.sights);
  if (used.empty()) {
    fill_unseen(mask, out.colour);
    return out;
  }
  const DeviceBvh& occluders = s.geometry("both");
  const double far_m = kFar * s.diagonal_m;
  const Vec3f eye =
      (chart.point(0.5 * chart.cols, 0.5 * chart.rows) - s.origin + far_m * chart.normal).cast<float>();
  // A pixel of that eye is a texel.
  const PhotoBlendView view{{eye.x(), eye.y(), eye.z()}, static_cast<float>(chart.texel_m / far_m)};

  const int side = s.options.tile;
  const auto capacity = static_cast<std::size_t>(std::min(side, chart.rows)) *
                        static_cast<std::size_t>(std::min(side, chart.cols));
  SurfaceTile surface(s.queue, capacity);
  s.store.use_levels({});
  PhotoBlend blend(s.queue, s.options, capacity);
  for (const Tile& part : make_tiles(chart.rows, chart.cols, side)) {
    surface.rows = static_cast<std::uint32_t>(part.rows);
    surface.cols = static_cast<std::uint32_t>(part.cols);
    const std::vector<float> planes = tile_surface(chart, mask, s.origin, part);
    s.queue.write(surface.surface, std::span<const float>(planes));
    blend.blend(s.store, occluders, s.everything(occluders), surface, view, used, s.store.linear());
    const device::Rect rect{static_cast<std::size_t>(part.row), static_cast<std::size_t>(part.col),
                            static_cast<std::size_t>(part.rows), static_cast<std::size_t>(part.cols)};
    s.queue.read_rect(blend.seen(), out.coverage.data(), cols, rect);
    s.queue.read_rect(blend.best(), out.best.data(), cols, rect);
    const device::Rect colours{rect.row, 3 * rect.col, rect.rows, 3 * rect.cols};
    s.queue.read_rect(blend.colour(), out.colour.data(), 3 * cols, colours);
  }
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (!mask[i]) std::fill_n(out.colour.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0.0f);
  return out;
}

}  // namespace hybrid::stages
