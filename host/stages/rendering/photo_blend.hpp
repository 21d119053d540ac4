#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "device/queue.hpp"
#include "stages/rendering/blend_bands.hpp"
#include "stages/rendering/photograph_store.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::stages {

// Among faces a shadow ray stops only this short of the surface: their coordinates are exact but for
// rounding.
inline constexpr float kFaceTolerance_m = 1e-3f;

// From where, and how finely, surface points are seen.
struct PhotoBlendView {
  std::array<float, 3> eye;  // local frame
  float pixel_rad;           // angle of one pixel
};

// The arrays that photographs are blended in, for tiles of up to `capacity` points; reused from tile to tile.
class PhotoBlend {
 public:
  PhotoBlend(device::Queue& queue, const RenderOptions& options, std::size_t capacity);

  // Colours of the surface points of `tile`, from the photographs `used`, which must be in increasing order.
  // `light`: what a byte counts as (3 x 256), per photograph of the scene: PhotographStore::linear(), or
  // anything else to be mixed by the same weights (not where photographs are split into bands).
  // Kernels: blend_photos once per photograph, or with weights = "ulr" rank_photos and then blend_ranked;
  // resolve_blend.
  void blend(PhotographStore& store, const DeviceBvh& occluders, const DeviceBvh& everything,
             const SurfaceTile& tile, const PhotoBlendView& view, const std::vector<std::size_t>& used,
             const std::vector<device::Array<float>>& light);

  const device::Array<float>& colour() const { return colour_; }      // linear RGB, interleaved
  const device::Array<std::uint32_t>& seen() const { return seen_; }  // photographs that see the point
  const device::Array<std::int32_t>& best() const { return best_; }   // the heaviest, -1 none

 private:
  void add(std::size_t index, const PhotographStore::Entry& photograph, const DeviceBvh& occluders,
           const SurfaceTile& tile, const PhotoBlendView& view, const device::Array<float>& light);
  void rank(PhotographStore& store, std::size_t index, const DeviceBvh& occluders,
            const DeviceBvh& everything, const SurfaceTile& tile, const PhotoBlendView& view);
  std::vector<std::size_t> ranked_photographs(std::size_t points);
  void add_ranked(std::size_t index, const PhotographStore::Entry& photograph, const SurfaceTile& tile,
                  const PhotoBlendView& view, const device::Array<float>& light);
  template <typename... Args>
  void launch(const char* name, const SurfaceTile& tile, const Args&... args);

  device::Queue& queue_;
  RenderOptions options_;
  BlendMode mode_;
  std::size_t kept_;  // photographs remembered per point; 0 where weights need no ranks
  device::Array<float> sums_, colour_, penalty_;
  device::Array<std::uint32_t> seen_;
  device::Array<std::int32_t> best_, ranked_;
  device::Array<std::uint8_t> no_pixels_;
};

}  // namespace hybrid::stages
