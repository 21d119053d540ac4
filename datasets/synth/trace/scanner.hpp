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
  int row = 0;  // of the grid, from the lowest: see grid_rows()

  bool returned() const { return true_range_m == true_range_m; }
};

// In place of samples that did not return.
Sample no_return();

// The grid that holds every sample of every column, each on a row of its own: a step of the mirror is a row,
// and a column that starts higher has its samples up there. What a sample measured is not moved; its
// elevation is off its row's by up to half a step, as columns start between rows, and the mirror's jitter.
int grid_rows(const ScannerPose&, const Preset&);
double lowest_row_rad(const Preset&);  // its elevation
double row_step_rad(const Preset&);
double first_column_rad(const Preset&);  // its azimuth
double column_step_rad(const Preset&);

struct ScanCounts {
  ScannerPose pose;
  std::size_t samples = 0;  // in the scan's file, a grid's empty places included
  std::size_t returns = 0;
  std::array<std::size_t, kSampleKinds> returns_of_kind{};
  std::size_t columns = 0, shortest_column = 0, longest_column = 0;
};

// Hands the returns to `take` column by column in acquisition order, rising within each; ScanCounts::samples
// stays 0. Memory holds a few columns a
// time, whatever the scan's size.
ScanCounts simulate_scan(const World&, const Tracer&, const ScannerPose&, const Options&,
                         std::uint64_t scan_index,
                         const std::function<void(const std::vector<Sample>&)>& take);

}  // namespace synth
