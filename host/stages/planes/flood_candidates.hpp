#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stages/planes/free_islands.hpp"
#include "stages/planes/plane_floods.hpp"

namespace hybrid::stages {

// A seed and how many samples its flood has.
struct FloodCandidate {
  std::size_t size = 0;
  WindowSeed seed;
  // Of a heap's order: the largest first, ties by the first sample, then by the first shape.
  bool operator<(const FloodCandidate& other) const {
    return size != other.size                 ? size < other.size
           : seed.sample != other.seed.sample ? seed.sample > other.seed.sample
                                              : seed.shape > other.seed.shape;
  }
};

// Floods from the seeds of each block that no earlier flood of the block covers, no farther than some samples
// around it: how much a seed is worth. Blocks do not see each other. Those of `least` samples and more.
std::vector<FloodCandidate> try_seeds(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                      const RangeNoise& noise, const std::vector<WindowSeed>& seeds,
                                      std::size_t least);

// Candidates whose floods may meet each other: of an island, or of several that a window looks into. The
// largest groups first.
std::vector<std::vector<FloodCandidate>> candidate_groups(const RangeImage& image,
                                                          const std::vector<std::uint8_t>& use,
                                                          const FreeIslands& islands,
                                                          const std::vector<FloodCandidate>& candidates);

}  // namespace hybrid::stages
