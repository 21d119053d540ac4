#include "stages/registration/icp_scan.hpp"

#include <algorithm>
#include <cmath>

#include "stages/registration/icp_pairs.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kStepOfFew = 8;

// Every `step`-th of the samples, for as many times its area.
IcpScan::Samples upload(device::Queue& queue, const PlanarSamples& from, std::size_t step) {
  IcpScan::Samples samples;
  for (std::size_t k = 0; k < from.points.size(); k += step) {
    samples.points.push_back(from.points[k]);
    samples.normals.push_back(from.normals[k]);
    samples.area_m2.push_back(from.points[k][3] * static_cast<float>(step));
    samples.points.back()[3] = samples.area_m2.back();
  }
  samples.queries = {samples.points.size(),
                     column(queue, samples.points, 0),
                     column(queue, samples.points, 1),
                     column(queue, samples.points, 2),
                     column(queue, samples.normals, 0),
                     column(queue, samples.normals, 1),
                     column(queue, samples.normals, 2)};
  samples.area = queue.array(samples.area_m2);
  return samples;
}

}  // namespace

ScanSamples choose_scan_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                const std::vector<std::uint8_t>& stray, int samples_of_each, int seed) {
  return {choose_planar_samples(image, segmentation, samples_of_each, seed),
          choose_free_samples(image, segmentation, stray, samples_of_each, seed)};
}

IcpScan::IcpScan(device::Queue& queue, const ScanSamples& chosen, const RangeImage& image,
                 const PlaneSegmentation& segmentation, const std::vector<std::uint8_t>& stray)
    : samples{upload(queue, chosen.planar, 1), upload(queue, chosen.free, 1)},
      few{upload(queue, chosen.planar, kStepOfFew), upload(queue, chosen.free, kStepOfFew)},
      fewest{upload(queue, chosen.planar, kStepOfFew * kStepOfFew),
             upload(queue, chosen.free, kStepOfFew * kStepOfFew)},
      surface(std::make_shared<ScanSurface>(queue, image, segmentation, stray)) {
  const auto each = [&](const auto& body) {
    for (const auto* list : {&chosen.planar.points, &chosen.free.points})
      for (const auto& p : *list) body(Vec3(p[0], p[1], p[2]), static_cast<double>(p[3]));
  };
  each([&](const Vec3& p, double area) {
    centre += area * p;
    area_m2 += area;
  });
  if (!(area_m2 > 0)) return;
  centre /= area_m2;
  double square = 0;
  each([&](const Vec3& p, double area) { square += area * (p - centre).squaredNorm(); });
  radius_m = std::sqrt(square / area_m2);
}

IcpScan::Samples IcpScan::bearing_on(device::Queue& queue, const Vec3& direction, double least,
                                     std::size_t most) const {
  PlanarSamples bearing;
  const Samples& planar = samples[kPlanar];
  for (std::size_t k = 0; k < planar.points.size(); ++k) {
    const auto& n = planar.normals[k];
    if (std::abs(direction.dot(Vec3(n[0], n[1], n[2]))) < least) continue;
    bearing.points.push_back(planar.points[k]);
    bearing.normals.push_back(n);
  }
  return upload(queue, bearing, std::max<std::size_t>((bearing.points.size() + most - 1) / most, 1));
}

}  // namespace hybrid::stages
