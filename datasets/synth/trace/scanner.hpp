#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "trace/tracer.hpp"
#include "world/world.hpp"

namespace synth {

// ghost: the beam went on from a pane of glass as from a mirror, and the scanner puts what it met behind the
// pane.
enum class SampleKind : std::uint8_t { planar, curved, mixed, ghost };
inline constexpr std::size_t kSampleKinds = 4;

struct Sample {
  Eigen::Vector3f point_in_scan;  // (0, 0, 0): no return (grids only)
  float intensity;
  std::uint32_t plane_id;  // 0: curved, mixed or ghost
  float true_range_m;      // of the beam's centre ray to the first surface, no noise; NaN: no return
  SampleKind kind;

  bool returned() const { return true_range_m == true_range_m; }
};

struct ScanCounts {
  ScannerPose pose;
  std::size_t samples = 0, returns = 0;  // samples without a return stand in grids only
  std::array<std::size_t, kSampleKinds> returns_of_kind{};
  std::size_t columns = 0, shortest_column = 0, longest_column = 0;
};

// Hands the columns to `take` in acquisition order, rising samples within each. Memory holds a few columns a
// time, whatever the scan's size.
ScanCounts simulate_scan(const World&, const Tracer&, const ScannerPose&, const Options&,
                         std::uint64_t scan_index,
                         const std::function<void(const std::vector<Sample>&)>& take);

}  // namespace synth
