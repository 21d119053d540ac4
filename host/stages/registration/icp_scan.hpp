#pragma once
#include <array>
#include <memory>
#include <vector>

#include "stages/registration/icp.hpp"
#include "stages/registration/scan_surface.hpp"

namespace hybrid::stages {

// What scan-to-scan ICP takes of one scan: some of its samples, evenly by area, and the surface that others'
// samples are laid on.
struct ScanSamples {
  PlanarSamples planar, free;  // choose_planar_samples, choose_free_samples
};
ScanSamples choose_scan_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                const std::vector<std::uint8_t>& stray, int samples_of_each, int seed);

class IcpScan {
 public:
  IcpScan(device::Queue& queue, const ScanSamples& samples, const RangeImage& image,
          const PlaneSegmentation& segmentation, const std::vector<std::uint8_t>& stray);

  static constexpr std::size_t kPlanar = 0;  // of the two kinds of samples
  // Samples of superclusters, and the others: their own areas and queries on the device.
  struct Samples {
    SearchQueries queries;
    std::vector<std::array<float, 4>> points;  // and area, square metres
    device::Array<float> area;
    std::vector<float> area_m2;
    std::vector<std::array<float, 4>> normals;
  };
  std::array<Samples, 2> samples;
  std::array<Samples, 2> few, fewest;  // every eighth of them, for eight times its area; of these the same
  std::shared_ptr<const ScanSurface> surface;
  Vec3 centre = Vec3::Zero();  // of the samples, by area
  double radius_m = 0;         // their rms distance from it
  double area_m2 = 0;          // of all samples

  // Of its planar samples at most `most`: those whose normal's component along the direction (scan frame,
  // unit) is at least `least`.
  Samples bearing_on(device::Queue& queue, const Vec3& direction, double least, std::size_t most) const;
};

}  // namespace hybrid::stages
