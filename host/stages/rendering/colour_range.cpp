#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel.hpp"
#include "stages/rendering/photo_blend.hpp"
#include "stages/rendering/render_state.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {
namespace {

// The tile's measured samples as surface points of the local frame, in the layout of kernels/ray_cast.cl.
std::vector<float> tile_surface(const RangeImage& image, const PlaneSegmentation& segmentation,
                                const Pose& local_from_scan, const Tile& tile) {
  const std::size_t count = static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.cols);
  std::vector<float> planes(SURFACE_PLANES * count, std::numeric_limits<float>::quiet_NaN());
  const SampleSurfaces surfaces(image, segmentation);
  parallel_for(static_cast<std::size_t>(tile.rows), [&](std::size_t row) {
    for (int col = 0; col < tile.cols; ++col) {
      const int image_row = tile.row + static_cast<int>(row), image_col = tile.col + col;
      const std::size_t from = image.index(image_row, image_col);
      if (image.mask[from] != kMeasured) continue;
      const std::size_t to = row * static_cast<std::size_t>(tile.cols) + static_cast<std::size_t>(col);
      const SampleSurface sample = surfaces.at(image_row, image_col);
      const Vec3f point = (local_from_scan * image.point(from)).cast<float>();
      const Vec3f normal = local_from_scan.rotate(sample.normal).cast<float>();
      for (std::size_t k = 0; k < 3; ++k) {
        planes[(SURFACE_X + k) * count + to] = point[static_cast<int>(k)];
        planes[(SURFACE_NORMAL_X + k) * count + to] = normal[static_cast<int>(k)];
      }
      const double radius_m = sample.radius_m * local_from_scan.scale;
      planes[SURFACE_RADIUS * count + to] = static_cast<float>(normal.isZero() ? -radius_m : radius_m);
    }
  });
  return planes;
}

float scan_step_rad(const RangeImage& image) {
  const double step = image.step_rad();
  return static_cast<float>(step > 0 ? step : 1e-3);
}

}  // namespace

Renderer::ColouredRange Renderer::colour_range_image(const RangeImage& image,
                                                     const PlaneSegmentation& segmentation,
                                                     const Pose& world_from_scan, int tile) {
  RenderState& s = *state_;
  ColouredRange out;
  out.colour = ImageF(image.cols, image.rows, 3, std::numeric_limits<float>::quiet_NaN());
  out.coverage.assign(image.count(), 0);
  out.shoulder = common_shoulder();
  const DeviceBvh& occluders = s.geometry("both");
  Pose local_from_scan = world_from_scan;
  local_from_scan.translation -= s.origin;
  const Vec3f eye = local_from_scan.translation.cast<float>();
  std::vector<std::size_t> used(s.scene.photographs.size());
  std::iota(used.begin(), used.end(), std::size_t{0});

  const auto capacity = static_cast<std::size_t>(std::min(tile, image.rows)) *
                        static_cast<std::size_t>(std::min(tile, image.cols));
  SurfaceTile surface(s.queue, capacity);
  s.store.use_levels({});
  PhotoBlend blend(s.queue, s.options, capacity);
  for (const Tile& part : make_tiles(image.rows, image.cols, tile)) {
    surface.rows = static_cast<std::uint32_t>(part.rows);
    surface.cols = static_cast<std::uint32_t>(part.cols);
    const std::vector<float> planes = tile_surface(image, segmentation, local_from_scan, part);
    s.queue.write(surface.surface, std::span<const float>(planes));
    const PhotoBlendView view{{eye.x(), eye.y(), eye.z()}, scan_step_rad(image)};
    blend.blend(s.store, occluders, occluders, surface, view, used, s.store.linear());
    const device::Rect rect{static_cast<std::size_t>(part.row), static_cast<std::size_t>(part.col),
                            static_cast<std::size_t>(part.rows), static_cast<std::size_t>(part.cols)};
    const auto cols = static_cast<std::size_t>(image.cols);
    s.queue.read_rect(blend.seen(), out.coverage.data(), cols, rect);
    const device::Rect colours{rect.row, 3 * rect.col, rect.rows, 3 * rect.cols};
    s.queue.read_rect(blend.colour(), out.colour.pixels.data(), 3 * cols, colours);
  }
  return out;
}

}  // namespace hybrid::stages
