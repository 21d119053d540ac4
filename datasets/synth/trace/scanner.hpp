#pragma once
#include <cstdint>
#include <vector>

#include "room/room.hpp"
#include "trace/tracer.hpp"

namespace synth {

enum class SampleKind : std::uint8_t { planar, curved, mixed };

struct Sample {
  Eigen::Vector3f point_in_scan;
  float intensity;
  std::uint32_t plane_id;  // 0: curved or mixed
  float true_range_m;      // of the beam's centre ray, no noise
  SampleKind kind;
};

struct Scan {
  ScannerPose pose;
  std::vector<Sample> samples;  // acquisition order: column by column, rising within each
  std::vector<std::uint32_t> samples_of_column;
};

Scan simulate_scan(const Room&, const Tracer&, const ScannerPose&, const RoomOptions&,
                   std::uint64_t scan_index);

}  // namespace synth
