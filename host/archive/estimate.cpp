#include "archive/estimate.hpp"

namespace hybrid::archive {
namespace {

// A process with its kernels built.
constexpr std::uint64_t kEmpty_bytes = 200'000'000;

// Seconds and bytes are the measured ones of README's section on batches, rounded up.
constexpr double kPlanes_s = 0.05, kPlanesPerSample_s = 3e-6;
constexpr std::uint64_t kPlanesPerSample_bytes = 300;
constexpr double kScene_s = 0.3, kScenePerSample_s = 4e-6, kScenePerPixel_s = 4e-6;
constexpr std::uint64_t kScenePerSample_bytes = 200, kScenePerPixel_bytes = 100;
// A JPEG of one byte holds about ten pixels of three channels, and is decoded beside its levels.
constexpr std::uint64_t kPerPhotographByte_bytes = 40;

}  // namespace

Estimate estimate_planes(std::uint64_t samples) {
  return {kPlanes_s + kPlanesPerSample_s * static_cast<double>(samples),
          kEmpty_bytes + kPlanesPerSample_bytes * samples};
}

Estimate estimate_scene(std::uint64_t samples, std::uint64_t photograph_bytes, std::uint64_t view_pixels) {
  return {kScene_s + kScenePerSample_s * static_cast<double>(samples) +
              kScenePerPixel_s * static_cast<double>(view_pixels),
          kEmpty_bytes + kScenePerSample_bytes * samples + kScenePerPixel_bytes * view_pixels +
              kPerPhotographByte_bytes * photograph_bytes};
}

}  // namespace hybrid::archive
