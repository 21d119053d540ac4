#include "archive/estimate.hpp"

#include <algorithm>

namespace hybrid::archive {
namespace {

// A process with its kernels built that has made another unit before.
constexpr std::uint64_t kEmpty_bytes = 240'000'000;
// The report's two pictures of a registration, which have one size, whatever the scene.
constexpr std::uint64_t kPictures_bytes = 200'000'000;

// Measured with bench/scaling/model.py on 20 scans of 0.04 to 5 million samples and 7 scenes of 0.2 to 2.8,
// and on scans of 20 and 100 million (bench/RESULTS.md), whose share of temporary arrays is less: within a
// factor of 2. kScene_s is of 27 November (bench/scaling/nights.py, 100 scenes).
constexpr double kPlanes_s = 0.05, kPlanesPerSample_s = 1.5e-6;
constexpr std::uint64_t kPlanesPerSample_bytes = 130, kPlanesPerFurtherSample_bytes = 65;
constexpr std::uint64_t kFewSamples = 4'000'000;
constexpr double kScene_s = 0.8, kScenePerSample_s = 2e-6, kScenePerPixel_s = 1.7e-6,
                 kPerPhotographPixel_s = 1e-7, kPerPairOfScans_s = 0.5;
constexpr std::uint64_t kScenePerSample_bytes = 130, kScenePerPixel_bytes = 40, kPerPhotographPixel_bytes = 8;
constexpr std::uint64_t kPixelsPerByte = 3;  // of a JPEG file
constexpr double kReport_s = 0.02, kReportPerUnit_s = 0.0007;
constexpr std::uint64_t kReportPerUnit_bytes = 10'000;

}  // namespace

Estimate estimate_planes(std::uint64_t samples) {
  const std::uint64_t few = std::min(samples, kFewSamples);
  return {kPlanes_s + kPlanesPerSample_s * static_cast<double>(samples),
          kEmpty_bytes + kPlanesPerSample_bytes * few + kPlanesPerFurtherSample_bytes * (samples - few)};
}

Estimate estimate_scene(const SceneSize& size) {
  const std::uint64_t photograph_pixels = kPixelsPerByte * size.photograph_bytes;
  const std::uint64_t pixels = size.view_pixels + size.photograph_views * photograph_pixels /
                                                      std::max<std::uint64_t>(1, size.photographs);
  const std::uint64_t pairs = size.model || size.scans == 0 ? 0 : size.scans * (size.scans - 1);
  return {kScene_s + kScenePerSample_s * static_cast<double>(size.samples) +
              kPerPairOfScans_s * static_cast<double>(pairs) +
              kScenePerPixel_s * static_cast<double>(pixels) +
              kPerPhotographPixel_s * static_cast<double>(photograph_pixels),
          kEmpty_bytes + kPictures_bytes + kScenePerSample_bytes * size.samples +
              kScenePerPixel_bytes * pixels + kPerPhotographPixel_bytes * photograph_pixels};
}

Estimate estimate_report(std::uint64_t units) {
  return {kReport_s + kReportPerUnit_s * static_cast<double>(units),
          kEmpty_bytes + kReportPerUnit_bytes * units};
}

}  // namespace hybrid::archive
