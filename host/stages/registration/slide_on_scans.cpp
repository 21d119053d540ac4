#include "stages/registration/slide_on_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stages/registration/line_of_places.hpp"

namespace hybrid::stages {
namespace {

// Places are compared within these shares of overlap_m, the finer near the best of the others; then robust
// ICP within so many times that.
constexpr double kWithin = 0.2, kFinerWithin = 0.04, kGateAlong = 4;
constexpr int kFinerPlaces = 6;
constexpr std::size_t kMostSamples = 20000;  // of each scan

std::string doubt(const SlideOnScans& found, double area_m2, bool converged, const SlideOptions& options) {
  if (found.on_m2 < options.least_share * area_m2)
    return fmt::format(
        "hardly anything that the other scans see of it bears on that: {:.2f} m2, at least "
        "{:.2f} should",
        found.on_m2, options.least_share * area_m2);
  if (found.elsewhere > options.most_elsewhere)
    return fmt::format("another place along it fits the other scans {:.0f} % as well", 100 * found.elsewhere);
  if (found.seen_through() > options.most_through)
    return fmt::format("where it fits the other scans best, these see through {:.0f} % of what bears on it",
                       100 * found.seen_through());
  if (std::abs(found.shift_m) > options.reach_m || !converged)
    return fmt::format("the other scans hold it nowhere within {:.2f} m", options.reach_m);
  if (const double most_m = kWithin * options.icp.overlap_m; found.sigma_m > most_m)
    return fmt::format(
        "the other scans hold it there to {:.0f} mm (one standard deviation), at most {:.0f} "
        "should be",
        1000 * found.sigma_m, 1000 * most_m);
  return "";
}

}  // namespace

SlideOnScans slide_on_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                            const Pose& world_from_scan, const Vec3& direction, const SlideOptions& options) {
  const ScanIcpOptions& icp = options.icp;
  LineOfPlaces line(queue, scan, placed, world_from_scan, direction, kMostSamples, icp);
  const double within_m = kWithin * icp.overlap_m, finer_m = kFinerWithin * icp.overlap_m;
  const int steps = static_cast<int>(std::ceil(options.reach_m / LineOfPlaces::step_m(within_m)));
  const auto places = line.places(0, within_m, steps);
  const auto& best = LineOfPlaces::best(places);
  SlideOnScans found;
  found.direction = direction;
  for (const auto& place : places)
    if (best.bearing.on_m2 > 0 && std::abs(place.shift_m - best.shift_m) > icp.overlap_m)
      found.elsewhere = std::max(found.elsewhere, place.bearing.on_m2 / best.bearing.on_m2);
  const auto near_best = line.places(best.shift_m, finer_m, kFinerPlaces);
  const auto settled = line.settle(LineOfPlaces::best(near_best).shift_m, kGateAlong * finer_m);
  found.shift_m = settled.shift_m;
  found.sigma_m = settled.sigma_m;
  const auto bearing = line.bearing(settled.shift_m, icp.overlap_m);
  found.on_m2 = bearing.on_m2;
  found.through_m2 = bearing.through_m2;
  found.on_other_m2 = bearing.on_other_m2;
  found.reason = doubt(found, scan.area_m2, settled.converged, options);
  found.accepted = found.reason.empty();
  return found;
}

}  // namespace hybrid::stages
