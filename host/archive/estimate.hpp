#pragma once
#include <cstdint>

namespace hybrid::archive {

// CPU seconds and peak memory of a unit before it has run, from what its inputs' headers tell.
struct Estimate {
  double cpu_s = 0;
  std::uint64_t bytes = 0;
};
Estimate estimate_planes(std::uint64_t samples);
// `photograph_bytes`: of their files, compressed. `view_pixels`: of views with a size of their own;
// `photograph_views`: those through one of the `photographs`. Without a model each of the `scans` may be
// tried on each other.
struct SceneSize {
  std::uint64_t samples = 0, photograph_bytes = 0, photographs = 0, view_pixels = 0, photograph_views = 0;
  std::uint64_t scans = 0;
  bool model = true;
};
Estimate estimate_scene(const SceneSize& size);
// The archive's page, of so many units.
Estimate estimate_report(std::uint64_t units);

}  // namespace hybrid::archive
