#include "stages/rendering/bvh.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/rendering/bvh_clusters.hpp"
#include "stages/rendering/bvh_collapse.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kBins = 16, kFewBins = 8;  // the few: of what fits a cluster
constexpr std::size_t kBinnedBlock =
    16384;  // items binned as one unit, fixed so that nothing depends on threads
constexpr std::size_t kParallelFrom = 256;  // smaller subtrees stay on one thread
constexpr std::size_t kLargestLeaf = BVH_LARGEST_LEAF;
constexpr int kDepthOfMedians =
    32;  // deeper nodes split at the median, so that the traversal's stack suffices
// Costs, in triangles: a node, and the spheres of a full leaf, which are tested at once.
constexpr float kNodeCost = 1, kSpheresCost = 1;
constexpr int kClusterLevels = std::bit_width(kLargestCluster);
static_assert((BVH_WIDTH - 1) * BVH_WIDE_LEVELS + kDepthOfMedians + BVH_COUNT_SHIFT + 1 + kClusterLevels <
              BVH_STACK);

// x, y, z and a fourth lane that is finite and of no meaning.
using Lanes = Eigen::Array4f;

struct LaneBox {
  Lanes low = Lanes::Constant(INFINITY), high = Lanes::Constant(-INFINITY);
  void add(const Lanes& l, const Lanes& h) {
    low = low.min(l);
    high = high.max(h);
  }
  void add(const LaneBox& box) { add(box.low, box.high); }
  float area() const {
    const Lanes e = high - low;
    return e[0] < 0 ? 0 : e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }
  BinaryBox stored() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

// What the tree is built of: a triangle, a sphere, or a cluster of spheres. As lanes of floats `code` and
// `weight` are finite and no denormals, which some processors are slow to add.
struct alignas(16) Item {
  static constexpr std::uint32_t kCluster = 0x80000000u, kNormal = 0x40000000u;
  float low[3];
  std::uint32_t code;  // index in its input, kNormal, kCluster for clusters
  float high[3];
  float weight;  // what its rays cost if it is a leaf; a single sphere's is 1

  Lanes lower() const { return Eigen::Map<const Lanes, Eigen::Aligned16>(low); }
  Lanes upper() const { return Eigen::Map<const Lanes, Eigen::Aligned16>(high); }
  Lanes centre2() const { return lower() + upper(); }  // twice the centre
  std::uint32_t index() const { return code & ~(kCluster | kNormal); }
  bool cluster() const { return (code & kCluster) != 0; }
};
static_assert(sizeof(Item) == 32);

struct Bin {
  LaneBox box;
  float weight = 0;
};
template <std::size_t Count>
using Bins = std::array<std::array<Bin, Count>, 3>;

struct Split {
  std::size_t axis = 3;  // 3 = none
  int bin = 0;           // first bin of the right side
  float cost = INFINITY;
};

// Which bin an item falls into, per axis.
struct Binning {
  Lanes origin, scale = Lanes::Zero(), last;
  Binning(const LaneBox& centres, std::size_t bins) : origin(centres.low) {
    const Lanes extent = centres.high - centres.low;
    for (int k = 0; k < 3; ++k) scale[k] = extent[k] > 0 ? static_cast<float>(bins) / extent[k] : 0;
    last = Lanes::Constant(static_cast<float>(bins - 1));
  }
  Eigen::Array4i bins(const Item& item) const {
    return ((item.centre2() - origin) * scale).max(0.0f).min(last).cast<int>();
  }
};

// The parts fold(from, to) makes of fixed blocks of [begin, end), on all threads, merged in order.
template <typename Part, typename Fold, typename Merge>
Part fold_blocks(std::size_t begin, std::size_t end, const Fold& fold, const Merge& merge) {
  const std::size_t blocks = (end - begin + kBinnedBlock - 1) / kBinnedBlock;
  if (blocks <= 1) return fold(begin, end);
  std::vector<Part> parts(blocks);
  parallel_for(blocks, [&](std::size_t i) {
    parts[i] = fold(begin + i * kBinnedBlock, std::min(begin + (i + 1) * kBinnedBlock, end));
  });
  for (std::size_t i = 1; i < blocks; ++i) merge(parts[0], parts[i]);
  return parts[0];
}

// Boxes are grown by more than the rounding of a ray's box test, so that a flat one still lets rays in.
void grow(Item& item) {
  for (std::size_t k = 0; k < 3; ++k) {
    const float margin = 1e-6f * std::max(std::abs(item.low[k]), std::abs(item.high[k])) + 1e-7f;
    item.low[k] -= margin;
    item.high[k] += margin;
  }
}

Item bound(const TriangleRecord& t, std::size_t index) {
  Item item;
  for (std::size_t k = 0; k < 3; ++k) {
    item.low[k] = std::min({t.a[k], t.b[k], t.c[k]});
    item.high[k] = std::max({t.a[k], t.b[k], t.c[k]});
  }
  item.code = Item::kNormal | static_cast<std::uint32_t>(index);
  item.weight = 1;
  grow(item);
  return item;
}

Item bound(const SphereRecord& s, std::size_t index) {
  Item item;
  for (std::size_t k = 0; k < 3; ++k) {
    item.low[k] = s.centre[k] - s.radius;
    item.high[k] = s.centre[k] + s.radius;
  }
  item.code = Item::kNormal | static_cast<std::uint32_t>(index);
  item.weight = 1;
  grow(item);
  return item;
}

// What all subtrees share.
struct Work {
  const std::vector<SphereRecord>& spheres;
  SphereClusters clusters;
  tbb::concurrent_vector<BinaryNode> nodes;
};

struct Subtree {
  std::uint32_t code = BVH_EMPTY;
  LaneBox box;
  PlaceCosts costs{};
};

class Builder {
 public:
  // Leaves of `items` are of `kind` (0 or BVH_SPHERES) and begin `first` places later in their order.
  Builder(std::span<Item> items, std::uint32_t kind, std::size_t first, Work& work)
      : items_(items), kind_(kind), first_(first), work_(work) {}

  // The subtree of [begin, end).
  Subtree build(std::size_t begin, std::size_t end, int depth) {
    if (end - begin == 1 && items_[begin].cluster()) return build_cluster(items_[begin].index(), depth);
    LaneBox box, centres;
    measure(begin, end, box, centres);
    const std::size_t middle = split(begin, end, depth, box, centres);
    if (middle == begin) return leaf(begin, end, box);
    std::array<Subtree, 2> sides;
    const auto side = [&](std::size_t i) {
      sides[i] = i == 0 ? build(begin, middle, depth + 1) : build(middle, end, depth + 1);
    };
    if (end - begin >= kParallelFrom) {
      parallel_for(2, side);
    } else {
      side(0);
      side(1);
    }
    Subtree made{.box = box};
    const auto choice = PlaceChoice::best(sides[0].costs, sides[1].costs, kNodeCost * box.area(), made.costs);
    const BinaryNode node{
        {sides[0].box.stored(), sides[1].box.stored()}, {sides[0].code, sides[1].code}, choice};
    made.code = static_cast<std::uint32_t>(work_.nodes.push_back(node) - work_.nodes.begin());
    return made;
  }

 private:
  Subtree leaf(std::size_t begin, std::size_t end, const LaneBox& box) const {
    Subtree made{.box = box};
    made.code = BVH_LEAF | kind_ | static_cast<std::uint32_t>((end - begin - 1) << BVH_COUNT_SHIFT) |
                static_cast<std::uint32_t>(first_ + begin);
    made.costs.fill(box.area() * cost(static_cast<float>(end - begin)));
    return made;
  }

  Subtree build_cluster(std::uint32_t index, int depth) {
    const auto [begin, count] = work_.clusters.clusters[index];
    std::array<Item, kLargestCluster> items;
    std::uint32_t* const order = &work_.clusters.order[begin];
    for (std::size_t i = 0; i < count; ++i) items[i] = bound(work_.spheres[order[i]], order[i]);
    Builder builder({items.data(), count}, BVH_SPHERES, begin, work_);
    const Subtree made = builder.build(0, count, depth);
    for (std::size_t i = 0; i < count; ++i) order[i] = items[i].index();
    return made;
  }

  // What a ray that meets items of this weight costs.
  float cost(float weight) const {
    return kind_ == BVH_SPHERES ? kSpheresCost * std::ceil(weight / kLargestLeaf) : weight;
  }

  void measure(std::size_t begin, std::size_t end, LaneBox& box, LaneBox& centres) const {
    struct Part {
      LaneBox box, centres;
    };
    const auto fold = [&](std::size_t from, std::size_t to) {
      Part part;
      for (std::size_t i = from; i < to; ++i) {
        part.box.add(items_[i].lower(), items_[i].upper());
        const Lanes centre = items_[i].centre2();
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
  std::size_t split(std::size_t begin, std::size_t end, int depth, const LaneBox& box,
                    const LaneBox& centres) {
    const std::size_t count = end - begin;
    const auto first = items_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = items_.begin() + static_cast<std::ptrdiff_t>(end);
    const auto position = [&](auto at) { return static_cast<std::size_t>(at - items_.begin()); };
    if (count == 1) return begin;

    const bool few = count <= kLargestCluster;
    const Binning binning(centres, few ? kFewBins : kBins);
    Split best;
    if (depth < kDepthOfMedians)
      best = few ? cheapest<kFewBins>(begin, end, box, binning) : cheapest<kBins>(begin, end, box, binning);
    const auto add_weight = [](float sum, const Item& item) { return sum + item.weight; };
    if (count <= kLargestLeaf && !(best.cost < cost(std::accumulate(first, last, 0.0f, add_weight)))) {
      const auto middle = std::partition(first, last, [](const Item& item) { return !item.cluster(); });
      if (middle == last) return begin;
      if (middle != first) return position(middle);
    }
    if (best.axis < 3)
      return position(std::partition(first, last, [&](const Item& item) {
        return binning.bins(item)[static_cast<int>(best.axis)] < best.bin;
      }));

    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (centres.high[k] - centres.low[k] > centres.high[axis] - centres.low[axis]) axis = k;
    const auto middle = first + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(first, middle, last, [axis](const Item& a, const Item& b) {
      const float x = a.low[axis] + a.high[axis], y = b.low[axis] + b.high[axis];
      return x != y ? x < y : a.code < b.code;
    });
    return position(middle);
  }

  template <std::size_t Count>
  Split cheapest(std::size_t begin, std::size_t end, const LaneBox& box, const Binning& binning) const {
    const auto fold = [&](std::size_t from, std::size_t to) {
      Bins<Count> block;
      for (std::size_t i = from; i < to; ++i) {
        const Item& item = items_[i];
        const Lanes low = item.lower(), high = item.upper();
        const Eigen::Array4i at = binning.bins(item);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          Bin& bin = block[axis][static_cast<std::size_t>(at[static_cast<int>(axis)])];
          bin.box.add(low, high);
          bin.weight += item.weight;
        }
      }
      return block;
    };
    const auto bins = fold_blocks<Bins<Count>>(begin, end, fold, [](auto& sum, const auto& part) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t k = 0; k < Count; ++k) {
          sum[axis][k].box.add(part[axis][k].box);
          sum[axis][k].weight += part[axis][k].weight;
        }
    });

    Split best;
    const float area = std::max(box.area(), std::numeric_limits<float>::min());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (binning.scale[static_cast<int>(axis)] == 0) continue;
      std::array<float, Count> right_cost{};
      LaneBox right;
      float right_weight = 0;
      for (std::size_t k = Count - 1; k > 0; --k) {
        right.add(bins[axis][k].box);
        right_weight += bins[axis][k].weight;
        right_cost[k] = right_weight > 0 ? right.area() * cost(right_weight) : -1;
      }
      LaneBox left;
      float left_weight = 0;
      for (std::size_t k = 1; k < Count; ++k) {
        left.add(bins[axis][k - 1].box);
        left_weight += bins[axis][k - 1].weight;
        if (left_weight == 0 || right_cost[k] < 0) continue;
        const float whole = kNodeCost + (left.area() * cost(left_weight) + right_cost[k]) / area;
        if (whole < best.cost) best = {axis, static_cast<int>(k), whole};
      }
    }
    return best;
  }

  std::span<Item> items_;
  std::uint32_t kind_;
  std::size_t first_;
  Work& work_;
};

// Triangles, then clusters.
std::vector<Item> top_items(const std::vector<TriangleRecord>& triangles, const Work& work) {
  const auto& clusters = work.clusters.clusters;
  std::vector<Item> items(triangles.size() + clusters.size());
  parallel_for(
      items.size(),
      [&](std::size_t i) {
        if (i < triangles.size()) {
          items[i] = bound(triangles[i], i);
          return;
        }
        const auto [begin, count] = clusters[i - triangles.size()];
        LaneBox box;
        for (std::size_t k = begin; k < begin + count; ++k) {
          const Item sphere = bound(work.spheres[work.clusters.order[k]], 0);
          box.add(sphere.lower(), sphere.upper());
        }
        Item& item = items[i];
        for (int k = 0; k < 3; ++k) item.low[k] = box.low[k], item.high[k] = box.high[k];
        item.code = Item::kNormal | Item::kCluster | static_cast<std::uint32_t>(i - triangles.size());
        item.weight = kSpheresCost * std::ceil(static_cast<float>(count) / kLargestLeaf);
      },
      1024);
  return items;
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
  Work work{spheres, cluster_spheres(spheres), {}};
  std::vector<Item> items = top_items(triangles, work);
  tree.root = Builder(items, 0, 0, work).build(0, items.size(), 0).code;
  tree.nodes = std::move(work.nodes);
  tree.sphere_order = std::move(work.clusters.order);
  tree.triangle_order.resize(triangles.empty() ? 0 : items.size());
  for (std::size_t i = 0; i < tree.triangle_order.size(); ++i) tree.triangle_order[i] = items[i].index();
  return tree;
}

Bvh build_bvh(const std::vector<TriangleRecord>& triangles, const std::vector<SphereRecord>& spheres,
              const Bvh& beside) {
  return collapse(build_binary_tree(triangles, spheres), triangles, spheres, beside);
}

DeviceBvh upload_bvh(device::Queue& queue, const Bvh& bvh, const std::vector<SphereSurface>& surfaces) {
  std::vector<SphereSurface> ordered(bvh.spheres.size());
  for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = surfaces[bvh.sphere_source[i]];
  // The last leaf's spheres are read as those of a full one.
  auto spheres = queue.array<SphereRecord>(bvh.spheres.size() + kLargestLeaf - 1);
  queue.write(spheres, std::span<const SphereRecord>(bvh.spheres));
  return {queue.array(bvh.nodes),
          queue.array(bvh.triangles),
          std::move(spheres),
          queue.array(ordered),
          bvh.root,
          bvh.root,
          BVH_EMPTY};
}

}  // namespace hybrid::stages
