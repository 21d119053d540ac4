#include "stages/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/bvh_collapse.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kBins = 16;
constexpr std::size_t kBlock =
    16384;  // primitives binned as one unit, fixed so that nothing depends on threads
constexpr std::size_t kParallelFrom = 8192;  // smaller subtrees stay on one thread
constexpr std::size_t kLargestLeaf = BVH_LARGEST_LEAF;
constexpr int kDepthOfMedians =
    32;  // deeper nodes split at the median, so that the traversal's stack suffices
constexpr std::uint32_t kSphereBit = 0x80000000u;
static_assert((BVH_WIDTH - 1) * BVH_WIDE_LEVELS + kDepthOfMedians + BVH_COUNT_SHIFT + 1 < BVH_STACK);

using Box = BinaryBox;

struct Primitive {
  std::array<float, 3> low;
  std::uint32_t id;  // index in its input; kSphereBit set for spheres
  std::array<float, 3> high;
  std::uint32_t pad = 0;

  float centre2(std::size_t axis) const { return low[axis] + high[axis]; }  // twice the centre
  bool sphere() const { return (id & kSphereBit) != 0; }
};

struct Bin {
  Box box;
  std::size_t count = 0;
};
using Bins = std::array<std::array<Bin, kBins>, 3>;

struct Split {
  std::size_t axis = 3;  // 3 = none
  std::size_t bin = 0;   // first bin of the right side
  float cost = INFINITY;
};

// Which bin a primitive falls into, per axis.
struct Binning {
  std::array<float, 3> origin, scale;
  explicit Binning(const Box& centres) {
    for (std::size_t k = 0; k < 3; ++k) {
      origin[k] = centres.low[k];
      const float extent = centres.high[k] - centres.low[k];
      scale[k] = extent > 0 ? static_cast<float>(kBins) / extent : 0;
    }
  }
  std::size_t bin(const Primitive& p, std::size_t axis) const {
    const float at = (p.centre2(axis) - origin[axis]) * scale[axis];
    return std::min(static_cast<std::size_t>(std::max(at, 0.0f)), kBins - 1);
  }
};

// The parts fold(from, to) makes of fixed blocks of [begin, end), on all threads, merged in order.
template <typename Part, typename Fold, typename Merge>
Part fold_blocks(std::size_t begin, std::size_t end, const Fold& fold, const Merge& merge) {
  const std::size_t blocks = (end - begin + kBlock - 1) / kBlock;
  if (blocks <= 1) return fold(begin, end);
  std::vector<Part> parts(blocks);
  parallel_for(blocks, [&](std::size_t i) {
    parts[i] = fold(begin + i * kBlock, std::min(begin + (i + 1) * kBlock, end));
  });
  for (std::size_t i = 1; i < blocks; ++i) merge(parts[0], parts[i]);
  return parts[0];
}

class Builder {
 public:
  Builder(std::vector<Primitive>& primitives, tbb::concurrent_vector<BinaryNode>& nodes)
      : primitives_(primitives), nodes_(nodes) {}

  // The subtree of [begin, end): its code and box.
  std::uint32_t build(std::size_t begin, std::size_t end, int depth, Box& box) {
    Box centres;
    measure(begin, end, box, centres);
    const std::size_t middle = split(begin, end, depth, box, centres);
    if (middle == begin) {
      const std::uint32_t kind = primitives_[begin].sphere() ? BVH_SPHERES : 0;
      return BVH_LEAF | kind | static_cast<std::uint32_t>((end - begin - 1) << BVH_COUNT_SHIFT) |
             static_cast<std::uint32_t>(begin);
    }
    std::array<Box, 2> boxes;
    std::array<std::uint32_t, 2> children{};
    const auto side = [&](std::size_t i) {
      children[i] =
          i == 0 ? build(begin, middle, depth + 1, boxes[0]) : build(middle, end, depth + 1, boxes[1]);
    };
    if (end - begin >= kParallelFrom) {
      parallel_for(2, side);
    } else {
      side(0);
      side(1);
    }
    return static_cast<std::uint32_t>(nodes_.push_back({boxes, children}) - nodes_.begin());
  }

 private:
  void measure(std::size_t begin, std::size_t end, Box& box, Box& centres) const {
    struct Part {
      Box box, centres;
    };
    const auto fold = [&](std::size_t from, std::size_t to) {
      Part part;
      for (std::size_t i = from; i < to; ++i) {
        const Primitive& p = primitives_[i];
        part.box.add(p.low, p.high);
        const std::array<float, 3> centre{p.centre2(0), p.centre2(1), p.centre2(2)};
        part.centres.add(centre, centre);
      }
      return part;
    };
    const Part whole = fold_blocks<Part>(begin, end, fold, [](Part& sum, const Part& part) {
      sum.box.add(part.box);
      sum.centres.add(part.centres);
    });
    box = whole.box;
    centres = whole.centres;
  }

  // Orders [begin, end) into two sides and returns where the second begins; `begin` for a leaf.
  std::size_t split(std::size_t begin, std::size_t end, int depth, const Box& box, const Box& centres) {
    const std::size_t count = end - begin;
    const auto first = primitives_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = primitives_.begin() + static_cast<std::ptrdiff_t>(end);
    const auto position = [&](auto at) { return static_cast<std::size_t>(at - primitives_.begin()); };
    if (count == 1) return begin;

    const Binning binning(centres);
    const Split best = depth < kDepthOfMedians ? cheapest(begin, end, box, binning) : Split{};
    if (count <= kLargestLeaf && !(best.cost < static_cast<float>(count))) {
      const auto middle = std::partition(first, last, [](const Primitive& p) { return !p.sphere(); });
      return middle == first || middle == last ? begin : position(middle);  // a leaf is of one kind
    }
    if (best.axis < 3)
      return position(std::partition(
          first, last, [&](const Primitive& p) { return binning.bin(p, best.axis) < best.bin; }));

    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (centres.high[k] - centres.low[k] > centres.high[axis] - centres.low[axis]) axis = k;
    const auto middle = first + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(first, middle, last, [axis](const Primitive& a, const Primitive& b) {
      return a.centre2(axis) != b.centre2(axis) ? a.centre2(axis) < b.centre2(axis) : a.id < b.id;
    });
    return position(middle);
  }

  Split cheapest(std::size_t begin, std::size_t end, const Box& box, const Binning& binning) const {
    const auto fold = [&](std::size_t from, std::size_t to) {
      Bins block;
      for (std::size_t i = from; i < to; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          Bin& bin = block[axis][binning.bin(primitives_[i], axis)];
          bin.box.add(primitives_[i].low, primitives_[i].high);
          ++bin.count;
        }
      return block;
    };
    const Bins bins = fold_blocks<Bins>(begin, end, fold, [](Bins& sum, const Bins& part) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t k = 0; k < kBins; ++k) {
          sum[axis][k].box.add(part[axis][k].box);
          sum[axis][k].count += part[axis][k].count;
        }
    });

    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<float, kBins> right_cost{};
      Box right;
      std::size_t right_count = 0;
      for (std::size_t k = kBins - 1; k > 0; --k) {
        right.add(bins[axis][k].box);
        right_count += bins[axis][k].count;
        right_cost[k] = right_count ? right.area() * static_cast<float>(right_count) : -1;
      }
      Box left;
      std::size_t left_count = 0;
      for (std::size_t k = 1; k < kBins; ++k) {
        left.add(bins[axis][k - 1].box);
        left_count += bins[axis][k - 1].count;
        if (left_count == 0 || right_cost[k] < 0) continue;
        // One node costs as much as one primitive.
        const float area = std::max(box.area(), std::numeric_limits<float>::min());
        const float cost = 1 + (left.area() * static_cast<float>(left_count) + right_cost[k]) / area;
        if (cost < best.cost) best = {axis, k, cost};
      }
    }
    return best;
  }

  std::vector<Primitive>& primitives_;
  tbb::concurrent_vector<BinaryNode>& nodes_;
};

// Boxes are grown by more than the rounding of a ray's box test, so that a flat one still lets rays in.
void grow(Primitive& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    const float margin = 1e-6f * std::max(std::abs(p.low[k]), std::abs(p.high[k])) + 1e-7f;
    p.low[k] -= margin;
    p.high[k] += margin;
  }
}

std::vector<Primitive> bound(const std::vector<TriangleRecord>& triangles,
                             const std::vector<SphereRecord>& spheres) {
  std::vector<Primitive> primitives(triangles.size() + spheres.size());
  parallel_for(
      primitives.size(),
      [&](std::size_t i) {
        Primitive& p = primitives[i];
        if (i < triangles.size()) {
          const TriangleRecord& t = triangles[i];
          for (std::size_t k = 0; k < 3; ++k) {
            p.low[k] = std::min({t.a[k], t.b[k], t.c[k]});
            p.high[k] = std::max({t.a[k], t.b[k], t.c[k]});
          }
          p.id = static_cast<std::uint32_t>(i);
        } else {
          const SphereRecord& s = spheres[i - triangles.size()];
          for (std::size_t k = 0; k < 3; ++k) {
            p.low[k] = s.centre[k] - s.radius;
            p.high[k] = s.centre[k] + s.radius;
          }
          p.id = kSphereBit | static_cast<std::uint32_t>(i - triangles.size());
        }
        grow(p);
      },
      kBlock);
  return primitives;
}

}  // namespace

BinaryTree build_binary_tree(const std::vector<TriangleRecord>& triangles,
                             const std::vector<SphereRecord>& spheres) {
  const std::size_t count = triangles.size() + spheres.size();
  if (count > BVH_FIRST_MASK)
    fail_input("render: expected at most {} triangles and splats together, found {}; keep fewer samples",
               BVH_FIRST_MASK, count);
  BinaryTree tree;
  if (count == 0) return tree;
  std::vector<Primitive> primitives = bound(triangles, spheres);
  Box box;
  tree.root = Builder(primitives, tree.nodes).build(0, count, 0, box);
  tree.order.resize(count);
  for (std::size_t i = 0; i < count; ++i) tree.order[i] = primitives[i].id & ~kSphereBit;
  return tree;
}

Bvh build_bvh(const std::vector<TriangleRecord>& triangles, const std::vector<SphereRecord>& spheres) {
  const BinaryTree tree = build_binary_tree(triangles, spheres);
  Bvh out;
  if (tree.root != BVH_EMPTY) collapse(tree, triangles, spheres, out);
  return out;
}

DeviceBvh upload_bvh(device::Queue& queue, const Bvh& bvh, const std::vector<SphereSurface>& surfaces) {
  std::vector<SphereSurface> ordered(bvh.spheres.size());
  for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = surfaces[bvh.sphere_source[i]];
  // The last leaf's spheres are read as those of a full one.
  auto spheres = queue.array<SphereRecord>(bvh.spheres.size() + kLargestLeaf - 1);
  queue.write(spheres, std::span<const SphereRecord>(bvh.spheres));
  return {queue.array(bvh.nodes), queue.array(bvh.triangles), std::move(spheres), queue.array(ordered),
          bvh.root};
}

}  // namespace hybrid::stages
