#include "stages/registration/seen_samples.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

// Leaves and railings are seen through from elsewhere: where planes are so much of what can be compared, they
// alone tell what is seen through.
constexpr double kPlanesTell = 0.2;
constexpr int kSamplesOfPlane = 5;     // seen through, that contradict it
constexpr double kLeastOfScan = 0.01;  // of its area, of a plane whose height counts

}  // namespace

const std::array<IcpScan::Samples, 2>& samples_of(const IcpScan& scan, const ScanIcpOptions& options) {
  return options.fewest ? scan.fewest : options.few ? scan.few : scan.samples;
}

void tell_free(const Seen& free, PlaceEvidence& evidence) {
  evidence.free_m2 = free.all();
  evidence.free_seen_through = free.all() > 0 ? free.through / free.all() : 0;
}

void tell(const Seen& planar, const Seen& free, PlaceEvidence& evidence) {
  tell_free(free, evidence);
  const bool by_planes = planar.all() > kPlanesTell * (planar.all() + free.all());
  const Seen judge{planar.on + (by_planes ? 0 : free.on), planar.through + (by_planes ? 0 : free.through)};
  evidence.seen_through = judge.all() > 0 ? judge.through / judge.all() : 0;
}

void add_seen(const IcpScan::Samples& samples, std::span<const float> heights,
              std::span<const float> clearances, const ScanIcpOptions& options, Seen& seen) {
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (std::abs(static_cast<double>(heights[i])) < options.overlap_m)
      seen.on += samples.area_m2[i];
    else if (static_cast<double>(clearances[i]) > options.clear_m)
      seen.through += samples.area_m2[i];
}

// The samples of a supercluster follow each other and share its normal.
void add_planes(const IcpScan::Samples& samples, double scan_m2, std::span<const float> heights,
                std::span<const float> clearances, const Pose& world_from_samples,
                const ScanIcpOptions& options, ComparedPlanes& planes) {
  for (std::size_t begin = 0, end = 0; begin < heights.size(); begin = end) {
    double on = 0, through = 0, beside = 0, moment = 0;
    int seen_through = 0, seen_beside = 0;
    for (end = begin; end < heights.size() && samples.normals[end] == samples.normals[begin]; ++end) {
      const double area = samples.area_m2[end], height = heights[end], clearance = clearances[end];
      if (std::abs(height) < options.overlap_m) {
        on += area;
        moment += area * height;
      } else if (clearance > options.clear_m) {
        through += area;
        ++seen_through;
      } else if (clearance > options.overlap_m || std::abs(height) < options.clear_m) {
        beside += area;
        ++seen_beside;
      }
    }
    const auto& n = samples.normals[begin];
    const Vec3 normal = world_from_samples.rotate(Vec3(n[0], n[1], n[2]));
    planes.on += on * normal * normal.transpose();
    planes.through += through * normal * normal.transpose();
    if (through > on && seen_through >= kSamplesOfPlane) planes.contradicted_m2 += through;
    if (beside > on && seen_beside >= kSamplesOfPlane) planes.beside_m2 += beside;
    if (on >= kLeastOfScan * scan_m2 && on > 0)
      planes.farthest_m = std::max(planes.farthest_m, std::abs(moment) / on);
  }
}

}  // namespace hybrid::stages
