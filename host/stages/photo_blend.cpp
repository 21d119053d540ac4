#include "stages/photo_blend.hpp"

#include "shared/params_blend_photos.h"

namespace hybrid::stages {
namespace {

// Among faces a shadow ray stops only this short of the surface: their coordinates are exact but for
// rounding.
constexpr float kFaceTolerance_m = 1e-3f;

std::uint32_t blend_mode(const RenderOptions& options) {
  return options.blend == "nearest" ? BLEND_NEAREST : options.blend == "linear" ? BLEND_LINEAR : BLEND_DUAL;
}

template <typename T>
void fill(device::Queue& queue, device::Array<T>& array, std::size_t count, T value) {
  const std::vector<T> values(count, value);
  queue.write(array, std::span<const T>(values));
}

}  // namespace

PhotoBlend::PhotoBlend(device::Queue& queue, std::size_t capacity)
    : queue_(queue),
      sums_(queue.array<float>(BLEND_PLANES * capacity)),
      colour_(queue.array<float>(3 * capacity)),
      seen_(queue.array<std::uint32_t>(capacity)),
      best_(queue.array<std::int32_t>(capacity)) {}

void PhotoBlend::blend(PhotographStore& store, const RenderOptions& options, const DeviceBvh& occluders,
                       const DeviceBvh& everything, const SurfaceTile& tile, const std::array<float, 3>& eye,
                       float pixel_rad, const std::vector<std::size_t>& used) {
  fill(queue_, sums_, BLEND_PLANES * tile.count(), 0.0f);
  fill(queue_, seen_, tile.count(), std::uint32_t{0});
  fill(queue_, best_, tile.count(), std::int32_t{-1});
  const auto& kernel = queue_.kernel("blend_photos", {{"VW", queue_.vector_width()}});
  for (std::size_t index : used) {
    const PhotographStore::Entry& photograph = store.get(index, everything);
    BlendPhotosParams params{};
    params.camera = photograph.camera;
    for (std::size_t k = 0; k < 3; ++k) params.eye[k] = eye[k];
    params.pixel_rad = pixel_rad;
    params.cols = tile.cols;
    params.rows = tile.rows;
    params.mode = blend_mode(options);
    params.photograph = static_cast<int>(index);
    params.feather_px = static_cast<float>(options.feather_px);
    params.tolerance_m = static_cast<float>(options.surface_tolerance_m);
    params.face_tolerance_m = kFaceTolerance_m;
    params.root = occluders.root;
    queue_.launch("blend_photos", kernel, packet_grid(queue_.vector_width(), tile.cols, tile.rows), params,
                  occluders.nodes, occluders.triangles, occluders.spheres, tile.surface, photograph.pixels,
                  photograph.low, store.linear(), sums_, seen_, best_);
  }
  const ResolveBlendParams resolve{static_cast<std::uint32_t>(tile.count()), blend_mode(options), {}};
  queue_.launch("resolve_blend", queue_.kernel("resolve_blend"), device::grid(tile.count()), resolve,
                tile.surface, sums_, seen_, colour_);
}

}  // namespace hybrid::stages
