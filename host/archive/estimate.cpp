#include "archive/estimate.hpp"

#include <algorithm>

namespace hybrid::archive {
namespace {

// A process with its kernels built.
constexpr std::uint64_t kEmpty_bytes = 220'000'000;
// The report's two pictures of a registration, which have one size, whatever the scene.
constexpr std::uint64_t kPictures_bytes = 150'000'000;

// Measured on the synthetic churches, presets tiny and demo.
constexpr double kPlanes_s = 0.05, kPlanesPerSample_s = 3e-6;
constexpr std::uint64_t kPlanesPerSample_bytes = 300;
constexpr double kScene_s = 1.5, kScenePerSample_s = 4e-6, kScenePerPixel_s = 4e-6,
                 kPerPhotographPixel_s = 1e-7;
constexpr std::uint64_t kScenePerSample_bytes = 200, kScenePerPixel_bytes = 100,
                        kPerPhotographPixel_bytes = 8;
constexpr std::uint64_t kPixelsPerByte = 8;  // of a JPEG file

}  // namespace

Estimate estimate_planes(std::uint64_t samples) {
  return {kPlanes_s + kPlanesPerSample_s * static_cast<double>(samples),
          kEmpty_bytes + kPlanesPerSample_bytes * samples};
}

Estimate estimate_scene(const SceneSize& size) {
  const std::uint64_t photograph_pixels = kPixelsPerByte * size.photograph_bytes;
  const std::uint64_t pixels = size.view_pixels + size.photograph_views * photograph_pixels /
                                                      std::max<std::uint64_t>(1, size.photographs);
  return {kScene_s + kScenePerSample_s * static_cast<double>(size.samples) +
              kScenePerPixel_s * static_cast<double>(pixels) +
              kPerPhotographPixel_s * static_cast<double>(photograph_pixels),
          kEmpty_bytes + kPictures_bytes + kScenePerSample_bytes * size.samples +
              kScenePerPixel_bytes * pixels + kPerPhotographPixel_bytes * photograph_pixels};
}

}  // namespace hybrid::archive
