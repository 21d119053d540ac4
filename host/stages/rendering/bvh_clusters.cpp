#include "stages/rendering/bvh_clusters.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

// A sphere's place on the curve in the upper bits, its index in the lower ones: all are different, so their
// order is one.
constexpr int kAxisBits = 12, kIndexBits = BVH_COUNT_SHIFT;
static_assert(3 * kAxisBits + kIndexBits <= 64);
constexpr std::size_t kSortedBlock = 65536;

// 12 bits, each followed by two zeros.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 16) & 0x00000f0000ffull;
  x = (x | x << 8) & 0x00000f00f00full;
  x = (x | x << 4) & 0x0000c30c30c3ull;
  return (x | x << 2) & 0x000249249249ull;
}

struct Bounds {
  std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  void add(const Bounds& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
};

class Clustering {
 public:
  explicit Clustering(const std::vector<SphereRecord>& spheres) : spheres_(spheres), keys_(spheres.size()) {
    parallel_for(
        keys_.size(), [&](std::size_t i) { keys_[i] = i; }, kSortedBlock);
  }

  SphereClusters run() {
    refine(0, keys_.size());
    made_.order.resize(keys_.size());
    parallel_for(
        keys_.size(), [&](std::size_t i) { made_.order[i] = index(i); }, kSortedBlock);
    return std::move(made_);
  }

 private:
  std::uint32_t index(std::size_t place) const {
    return static_cast<std::uint32_t>(keys_[place] & ((std::uint64_t{1} << kIndexBits) - 1));
  }

  Bounds measure(std::size_t begin, std::size_t end) const {
    std::vector<Bounds> parts((end - begin + kSortedBlock - 1) / kSortedBlock);
    parallel_for(parts.size(), [&](std::size_t b) {
      Bounds part;
      for (std::size_t i = begin + b * kSortedBlock; i < std::min(begin + (b + 1) * kSortedBlock, end); ++i) {
        const float* at = spheres_[index(i)].centre;
        part.add({{at[0], at[1], at[2]}, {at[0], at[1], at[2]}});
      }
      parts[b] = part;
    });
    Bounds whole;
    for (const Bounds& part : parts) whole.add(part);
    return whole;
  }

  // Orders [begin, end) along a curve through its own bounds and cuts it.
  void refine(std::size_t begin, std::size_t end) {
    if (end - begin <= kLargestCluster) return add(begin, end);
    const Bounds bounds = measure(begin, end);
    // Cells are cubes: splats lie on surfaces, whose clusters should be as wide as long.
    float extent = 0;
    for (std::size_t k = 0; k < 3; ++k) extent = std::max(extent, bounds.high[k] - bounds.low[k]);
    const float scale = std::ldexp(1.0f, kAxisBits) / extent;
    if (!(extent > 0) || !std::isfinite(extent) || !std::isfinite(scale)) return chunk(begin, end);
    constexpr float most = (1 << kAxisBits) - 1;
    parallel_for(
        end - begin,
        [&](std::size_t k) {
          const std::uint32_t sphere = index(begin + k);
          std::uint64_t code = 0;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const float at = (spheres_[sphere].centre[axis] - bounds.low[axis]) * scale;
            code |= spread(static_cast<std::uint32_t>(std::clamp(at, 0.0f, most))) << axis;
          }
          keys_[begin + k] = code << kIndexBits | sphere;
        },
        kSortedBlock);
    const auto first = keys_.begin() + static_cast<std::ptrdiff_t>(begin);
    tbb::parallel_sort(first, keys_.begin() + static_cast<std::ptrdiff_t>(end));
    cut(begin, end);
  }

  // [begin, end) shares the curve's bits above where its first and last differ.
  void cut(std::size_t begin, std::size_t end) {
    if (end - begin <= kLargestCluster) return add(begin, end);
    const std::uint64_t differ = (keys_[begin] ^ keys_[end - 1]) >> kIndexBits;
    if (differ == 0) return refine(begin, end);
    const std::uint64_t bit = std::bit_floor(differ) << kIndexBits;
    const auto first = keys_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto middle = std::partition_point(first, keys_.begin() + static_cast<std::ptrdiff_t>(end),
                                             [bit](std::uint64_t key) { return (key & bit) == 0; });
    const auto place = static_cast<std::size_t>(middle - keys_.begin());
    cut(begin, place);
    cut(place, end);
  }

  void chunk(std::size_t begin, std::size_t end) {
    for (; begin < end; begin += kLargestCluster) add(begin, std::min(begin + kLargestCluster, end));
  }

  void add(std::size_t begin, std::size_t end) {
    if (begin < end)
      made_.clusters.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
  }

  const std::vector<SphereRecord>& spheres_;
  std::vector<std::uint64_t> keys_;
  SphereClusters made_;
};

}  // namespace

SphereClusters cluster_spheres(const std::vector<SphereRecord>& spheres) {
  return Clustering(spheres).run();
}

}  // namespace hybrid::stages
