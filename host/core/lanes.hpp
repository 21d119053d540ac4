#pragma once
#include <array>
#include <cstddef>

namespace hybrid {

// Sums over many samples as loops over a fixed number of lanes, which the compiler turns into the widest
// vectors of the processor at hand (cpu_clones.hpp): every processor adds in the same order.
inline constexpr std::size_t kVectorLanes = 8;
using LaneValues = std::array<double, kVectorLanes>;

inline double sum_of_lanes(const LaneValues& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

}  // namespace hybrid
