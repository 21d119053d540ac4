#pragma once
#include <array>
#include <span>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// Area of samples of one kind, both ways.
struct Seen {
  double on = 0, through = 0;
  double all() const { return on + through; }
};

// By kind: all, an eighth or a sixty-fourth of a scan's samples, as the options say.
const std::array<IcpScan::Samples, 2>& samples_of(const IcpScan& scan, const ScanIcpOptions& options);

// What they say but for planes; tell_free(): free_seen_through and free_m2 alone.
void tell(const Seen& planar, const Seen& free, PlaceEvidence& evidence);
void tell_free(const Seen& free, PlaceEvidence& evidence);

// Adds samples of one scan on the surfaces of another. `heights`, `clearances`: what closest_sample.cl
// answers, world metres.
void add_seen(const IcpScan::Samples& samples, std::span<const float> heights,
              std::span<const float> clearances, const ScanIcpOptions& options, Seen& seen);
// Of planar ones, what they tell of their planes. `scan_m2`: the area of all of their scan.
void add_planes(const IcpScan::Samples& samples, double scan_m2, std::span<const float> heights,
                std::span<const float> clearances, const Pose& world_from_samples,
                const ScanIcpOptions& options, ComparedPlanes& planes);

}  // namespace hybrid::stages
