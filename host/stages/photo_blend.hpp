#pragma once
#include <cstdint>
#include <vector>

#include "device/queue.hpp"
#include "stages/photograph_store.hpp"
#include "stages/render_geometry.hpp"

namespace hybrid::stages {

// The arrays blend_photos sums into, for tiles of up to `capacity` points; reused from tile to tile.
class PhotoBlend {
 public:
  PhotoBlend(device::Queue& queue, std::size_t capacity);

  // Colours of the surface points of `tile` as seen from `eye` (local frame), from the photographs `used`,
  // which must be in increasing order. Kernels: blend_photos once per photograph, resolve_blend.
  void blend(PhotographStore& store, const RenderOptions& options, const DeviceBvh& occluders,
             const DeviceBvh& everything, const SurfaceTile& tile, const std::array<float, 3>& eye,
             float pixel_rad, const std::vector<std::size_t>& used);

  const device::Array<float>& colour() const { return colour_; }      // linear RGB, interleaved
  const device::Array<std::uint32_t>& seen() const { return seen_; }  // photographs that see the point
  const device::Array<std::int32_t>& best() const { return best_; }   // the heaviest, -1 none

 private:
  device::Queue& queue_;
  device::Array<float> sums_, colour_;
  device::Array<std::uint32_t> seen_;
  device::Array<std::int32_t> best_;
};

}  // namespace hybrid::stages
