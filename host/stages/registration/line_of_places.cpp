#include "stages/registration/line_of_places.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

// Samples count whose normal's component along the line is this or more.
constexpr double kBears = 0.3;
constexpr double kSettledAlong_m = 1e-5;
constexpr double kGateOfCutoffAlong = 2;  // pairs beyond the robust weights' cutoff may come back

}  // namespace

LineOfPlaces::LineOfPlaces(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                           const Pose& world_from_scan, const Vec3& direction, std::size_t most_samples,
                           const ScanIcpOptions& options)
    : queue_(queue), placed_(placed), options_(options), start_(world_from_scan), direction_(direction) {
  const auto bearing = [&](const IcpScan& of, const Pose& pose) {
    return of.bearing_on(queue, pose.rotation.conjugate() * direction, kBears, most_samples);
  };
  own_ = bearing(scan, world_from_scan);
  theirs_.reserve(placed.size());  // pairs refer to them
  for (std::size_t k = 0; k < placed.size(); ++k) {
    theirs_.push_back(bearing(*placed[k].scan, placed[k].world_from_scan));
    if (placed[k].scan->surface->known()) add(k, own_, world_from_scan, *placed[k].scan->surface, true);
    if (scan.surface->known()) add(k, theirs_[k], placed[k].world_from_scan, *scan.surface, false);
  }
}

void LineOfPlaces::add(std::size_t other, const IcpScan::Samples& samples, const Pose& world_from_samples,
                       const ScanSurface& surface, bool forward) {
  OnOther one{other, ScanPairs(queue_, samples, surface, 0, forward), {}};
  for (std::size_t i = 0; i < samples.area_m2.size(); ++i) {
    const auto& n = samples.normals[i];
    const double along = direction_.dot(world_from_samples.rotate(Vec3(n[0], n[1], n[2])));
    one.bears_m2.push_back(along * along * samples.area_m2[i]);
  }
  all_.push_back(std::move(one));
}

Pose LineOfPlaces::at(double shift_m) const {
  Pose pose = start_;
  pose.translation += shift_m * direction_;
  return pose;
}

void LineOfPlaces::find(double shift_m, double gate_m) {
  const Pose pose = at(shift_m);
  for (auto& [other, pairs, bears_m2] : all_) {
    const Pose& there = placed_[other].world_from_scan;
    pairs.find(pairs.forward() ? pose : there, pairs.forward() ? there : pose, gate_m, options_.normal_deg);
  }
}

LineOfPlaces::Bearing LineOfPlaces::bearing(double shift_m, double within_m) {
  find(shift_m, within_m);
  Bearing sums;
  sums.on_other_m2.resize(placed_.size());
  for (auto& [other, pairs, bears_m2] : all_) {
    const auto &heights = pairs.heights(), &clearances = pairs.clearances();
    for (std::size_t i = 0; i < bears_m2.size(); ++i)
      if (std::abs(static_cast<double>(heights[i])) < within_m)
        sums.on_other_m2[other] += bears_m2[i];
      else if (static_cast<double>(clearances[i]) > options_.clear_m)
        sums.through_m2 += bears_m2[i];
  }
  for (const double on : sums.on_other_m2) sums.on_m2 += on;
  return sums;
}

std::vector<LineOfPlaces::Place> LineOfPlaces::places(double shift_m, double within_m, int steps) {
  std::vector<Place> places;
  for (int k = -steps; k <= steps; ++k) {
    const double place_m = shift_m + k * step_m(within_m);
    places.push_back({place_m, bearing(place_m, within_m)});
  }
  return places;
}

const LineOfPlaces::Place& LineOfPlaces::best(const std::vector<Place>& places) {
  return *std::max_element(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return a.bearing.speaks_m2() < b.bearing.speaks_m2();
  });
}

LineOfPlaces::Settled LineOfPlaces::settle(double shift_m, double gate_m) {
  Settled settled{shift_m};
  PairsCutoff cutoff(options_.scale_floor_m);
  for (int iteration = 0; iteration < options_.max_iterations && !settled.converged; ++iteration) {
    find(settled.shift_m, gate_m);
    std::vector<float> heights, areas;
    for (auto& [other, pairs, bears_m2] : all_) {
      const auto& own = pairs.used_heights();
      heights.insert(heights.end(), own.begin(), own.end());
      areas.insert(areas.end(), pairs.samples().area_m2.begin(), pairs.samples().area_m2.end());
    }
    if (!cutoff.update(heights, areas)) break;
    PlaneSums sums;
    PairObservations seen;
    for (auto& one : all_) one.pairs.sum(at(settled.shift_m).translation, cutoff.metres());
    for (auto& one : all_) {
      one.pairs.add_sums(1, sums);
      seen.add(one.pairs, cutoff.metres());
    }
    const double holds = direction_.dot(sums.matrix.block<3, 3>(3, 3) * direction_);
    if (!(holds > 0)) break;
    const double step = -direction_.dot(sums.right.segment<3>(3)) / holds;
    settled.shift_m += step;
    settled.sigma_m = cutoff.scale_m() * std::sqrt(sums.weight / (holds * seen.planes()));
    const double next = std::min(kGateOfCutoffAlong * cutoff.metres(), gate_m);
    settled.converged = std::abs(step) < kSettledAlong_m && cutoff.settled() && next > 0.9 * gate_m;
    gate_m = next;
  }
  return settled;
}

}  // namespace hybrid::stages
