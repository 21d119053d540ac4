#include "stages/planes/flood_candidates.hpp"

#include <algorithm>
#include <map>

#include "core/disjoint_sets.hpp"
#include "core/parallel.hpp"
#include "geometry/tiles.hpp"

namespace hybrid::stages {
namespace {

constexpr int kBlockSide = 64, kAround = 16;  // samples; floods of a block look so far around it

}  // namespace

std::vector<FloodCandidate> try_seeds(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                      const RangeNoise& noise, const std::vector<WindowSeed>& seeds,
                                      std::size_t least) {
  const int block_cols = (image.cols + kBlockSide - 1) / kBlockSide,
            block_rows = (image.rows + kBlockSide - 1) / kBlockSide;
  std::vector<std::vector<WindowSeed>> of_block(static_cast<std::size_t>(block_cols) *
                                                static_cast<std::size_t>(block_rows));
  for (const WindowSeed& seed : seeds) {
    const int row = static_cast<int>(seed.sample) / image.cols,
              col = static_cast<int>(seed.sample) % image.cols;
    of_block[static_cast<std::size_t>(row / kBlockSide * block_cols + col / kBlockSide)].push_back(seed);
  }
  std::vector<std::vector<FloodCandidate>> found(of_block.size());
  parallel_for(of_block.size(), [&](std::size_t b) {
    const int row = static_cast<int>(b) / block_cols * kBlockSide,
              col = static_cast<int>(b) % block_cols * kBlockSide;
    const int top = std::max(row - kAround, 0), left = std::max(col - kAround, 0);
    const Tile limits{top, left, std::min(row + kBlockSide + kAround, image.rows) - top,
                      std::min(col + kBlockSide + kAround, image.cols) - left};
    if (of_block[b].empty()) return;
    std::sort(of_block[b].begin(), of_block[b].end(),
              [](const auto& one, const auto& other) { return one.sample < other.sample; });
    BlockFloods floods(image, use, noise, limits);
    for (const WindowSeed& seed : of_block[b]) {
      if (!floods.is_open(seed.member)) continue;
      const std::size_t size = floods.flood(seed, least);
      if (size >= least) found[b].push_back({size, seed});
    }
  });
  std::vector<FloodCandidate> candidates;
  for (const auto& list : found) candidates.insert(candidates.end(), list.begin(), list.end());
  return candidates;
}

std::vector<std::vector<FloodCandidate>> candidate_groups(const RangeImage& image,
                                                          const std::vector<std::uint8_t>& use,
                                                          const FreeIslands& islands,
                                                          const std::vector<FloodCandidate>& candidates) {
  DisjointSets sets(islands.count());
  for (const FloodCandidate& one : candidates)
    for (const std::uint32_t i : seed_samples(image, use, one.seed))
      sets.join(islands.island(one.seed.member), islands.island(i));
  std::map<std::uint32_t, std::vector<FloodCandidate>> of;
  for (const FloodCandidate& one : candidates) of[sets.of(islands.island(one.seed.member))].push_back(one);
  std::vector<std::vector<FloodCandidate>> groups;
  for (auto& [first, group] : of) groups.push_back(std::move(group));
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

}  // namespace hybrid::stages
