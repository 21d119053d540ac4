#pragma once
#include <cstdint>

namespace hybrid::archive {

// CPU seconds and peak memory of a unit before it has run, from what its inputs' headers tell.
struct Estimate {
  double cpu_s = 0;
  std::uint64_t bytes = 0;
};
Estimate estimate_planes(std::uint64_t samples);
// `photograph_bytes`: of their files, compressed.
Estimate estimate_scene(std::uint64_t samples, std::uint64_t photograph_bytes, std::uint64_t view_pixels);

}  // namespace hybrid::archive
