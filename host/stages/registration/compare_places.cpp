#include "stages/registration/compare_places.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "core/parallel.hpp"
#include "stages/registration/seen_samples.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kOthersAtOnce = 16;  // whose answers are in memory

// Samples of one scan on the surface of another, and what is answered of them at each place.
struct Asked {
  const IcpScan::Samples* samples;
  const PlacedScan* other;
  std::size_t kind;
  bool forward;  // the samples are of the scan that is moved
  SampleAnswers answers;
  std::vector<float> heights{}, clearances{};

  std::span<const float> at(const std::vector<float>& values, std::size_t place) const {
    const std::size_t count = samples->queries.count;
    return std::span(values).subspan(place * count, count);
  }
};

void scale(std::span<float> values, double factor) {
  if (factor != 1)
    for (float& value : values) value *= static_cast<float>(factor);
}

class ManyPlaces {
 public:
  ManyPlaces(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
             const ScanIcpOptions& options)
      : queue_(queue), scan_(scan), placed_(placed), options_(options) {}

  // Of places of one scale.
  void compare(std::span<const Pose> places, std::span<PlaceEvidence> found) {
    std::vector<std::array<Seen, 2>> seen(places.size());
    for (std::size_t begin = 0; begin < placed_.size(); begin += kOthersAtOnce) {
      const auto some = std::span(placed_).subspan(begin, std::min(kOthersAtOnce, placed_.size() - begin));
      const auto all = answers_on(some, places);
      parallel_for(places.size(), [&](std::size_t p) { add(all, places[p], p, seen[p], found[p].planes); });
    }
    for (std::size_t p = 0; p < places.size(); ++p)
      tell(seen[p][IcpScan::kPlanar], seen[p][1 - IcpScan::kPlanar], found[p]);
  }

 private:
  std::vector<Asked> answers_on(std::span<const PlacedScan> placed, std::span<const Pose> places) {
    std::vector<Asked> all;
    for (const PlacedScan& other : placed)
      for (std::size_t kind = 0; kind < 2; ++kind) {
        if (other.scan->surface->known()) ask(scan_, other, kind, true, places, all);
        if (scan_.surface->known()) ask(*other.scan, other, kind, false, places, all);
      }
    for (Asked& asked : all) {
      asked.heights = queue_.read(asked.answers.height);
      asked.clearances = queue_.read(asked.answers.clearance);
      const double metres = asked.forward ? asked.other->world_from_scan.scale : places[0].scale;
      scale(asked.heights, metres);
      scale(asked.clearances, metres);
    }
    return all;
  }

  void ask(const IcpScan& of, const PlacedScan& other, std::size_t kind, bool forward,
           std::span<const Pose> places, std::vector<Asked>& all) {
    const auto& samples = samples_of(of, options_)[kind];
    if (samples.queries.count == 0) return;
    const Pose& there = other.world_from_scan;
    std::vector<Pose> surface_from_samples;
    for (const Pose& place : places)
      surface_from_samples.push_back(forward ? there.inverse() * place : place.inverse() * there);
    const double metres = forward ? there.scale : places[0].scale;
    all.push_back(
        {&samples, &other, kind, forward, SampleAnswers(queue_, samples.queries.count, places.size())});
    (forward ? *other.scan : scan_)
        .surface->find(samples.queries, surface_from_samples, options_.overlap_m / metres,
                       options_.normal_deg, all.back().answers);
  }

  void add(const std::vector<Asked>& all, const Pose& place, std::size_t p, std::array<Seen, 2>& seen,
           ComparedPlanes& planes) const {
    for (const Asked& asked : all) {
      const auto heights = asked.at(asked.heights, p), clearances = asked.at(asked.clearances, p);
      add_seen(*asked.samples, heights, clearances, options_, seen[asked.kind]);
      if (asked.kind == IcpScan::kPlanar)
        add_planes(*asked.samples, (asked.forward ? scan_ : *asked.other->scan).area_m2, heights, clearances,
                   asked.forward ? place : asked.other->world_from_scan, options_, planes);
    }
  }

  device::Queue& queue_;
  const IcpScan& scan_;
  const std::vector<PlacedScan>& placed_;
  const ScanIcpOptions& options_;
};

}  // namespace

std::vector<PlaceEvidence> compare_places(device::Queue& queue, const IcpScan& scan,
                                          const std::vector<PlacedScan>& placed,
                                          const std::vector<Pose>& places, const ScanIcpOptions& options) {
  ManyPlaces many(queue, scan, placed, options);
  std::vector<PlaceEvidence> found(places.size());
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    while (end < places.size() && end - begin < CLOSEST_SAMPLE_PLACES &&
           places[end].scale == places[begin].scale)
      ++end;
    many.compare(std::span(places).subspan(begin, end - begin), std::span(found).subspan(begin, end - begin));
  }
  return found;
}

}  // namespace hybrid::stages
