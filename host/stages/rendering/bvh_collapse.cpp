#include "stages/rendering/bvh_collapse.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/parallel.hpp"
#include "stages/rendering/bvh_join.hpp"

namespace hybrid::stages {
namespace {

// Wide nodes this far below the root are pulled together on all threads, each into a tree of its own.
constexpr std::size_t kBranchLevel = 3;
constexpr std::size_t kCopiedBlock = 16384;  // spheres copied as one unit

struct Child {
  BinaryBox box;
  std::uint32_t code;
};

// A subtree left for later: where its code belongs, and the subtree.
struct Branch {
  std::size_t node, child;
  std::uint32_t code;
};

class Collapse {
 public:
  // `branches`: what lies at kBranchLevel; null: nothing is left for later.
  Collapse(const BinaryTree& tree, const std::vector<TriangleRecord>& triangles,
           std::vector<Branch>* branches, Bvh& out)
      : tree_(tree), triangles_(triangles), branches_(branches), out_(out) {}

  // The final code of the subtree of `code`, which lies `level` wide nodes below the root.
  std::uint32_t visit(std::uint32_t code, std::size_t level) {
    if (code & BVH_LEAF) return leaf(code);
    // A traversal's stack holds what wide nodes leave pending, so their number is bounded; below, the tree
    // stays as it is. Only trees of exponentially spaced primitives reach that far down.
    const std::vector<Child> children = open(code, level < BVH_WIDE_LEVELS ? BVH_WIDTH : 2);
    const std::size_t index = out_.nodes.size();
    out_.nodes.push_back(empty_node());
    for (std::size_t i = 0; i < children.size(); ++i) {
      const BinaryBox& box = children[i].box;
      const bool later = branches_ && level + 1 == kBranchLevel && !(children[i].code & BVH_LEAF);
      if (later) branches_->push_back({index, i, children[i].code});
      const std::uint32_t final_code = later ? BVH_EMPTY : visit(children[i].code, level + 1);
      BvhNode& node = out_.nodes[index];
      node.low_x[i] = box.low[0], node.low_y[i] = box.low[1], node.low_z[i] = box.low[2];
      node.high_x[i] = box.high[0], node.high_y[i] = box.high[1], node.high_z[i] = box.high[2];
      node.child[i] = final_code;
    }
    return static_cast<std::uint32_t>(index);
  }

 private:
  std::vector<Child> open(std::uint32_t code, std::size_t width) const {
    std::vector<Child> children;
    children.reserve(width);
    share_out(tree_.nodes[code], width, children);
    return children;
  }

  // The children of a node that takes this many places.
  void share_out(const BinaryNode& node, std::size_t places, std::vector<Child>& out) const {
    const std::size_t left = places == 2 ? 1 : node.choice.left[places];
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t own = i == 0 ? left : places - left;
      const std::uint32_t code = node.children[i];
      if (code & BVH_LEAF || own < tree_.nodes[code].choice.opens_from) {
        out.push_back({node.boxes[i], code});
      } else {
        share_out(tree_.nodes[code], own, out);
      }
    }
  }

  std::uint32_t leaf(std::uint32_t code) {
    if (code & BVH_SPHERES) return code;  // spheres lie in the order of their leaves already
    const std::size_t begin = code & BVH_FIRST_MASK, first = out_.triangles.size();
    const std::size_t count = ((code >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1;
    for (std::size_t i = begin; i < begin + count; ++i)
      out_.triangles.push_back(triangles_[tree_.triangle_order[i]]);
    return (code & ~BVH_FIRST_MASK) | static_cast<std::uint32_t>(first);
  }

  const BinaryTree& tree_;
  const std::vector<TriangleRecord>& triangles_;
  std::vector<Branch>* branches_;
  Bvh& out_;
};

}  // namespace

PlaceChoice PlaceChoice::best(const PlaceCosts& left, const PlaceCosts& right, float own, PlaceCosts& costs) {
  PlaceChoice choice;
  for (std::size_t places = 2; places <= BVH_WIDTH; ++places) {
    costs[places] = INFINITY;
    for (std::size_t k = 1; k < places; ++k)
      if (const float cost = left[k] + right[places - k]; cost < costs[places]) {
        costs[places] = cost;
        choice.left[places] = static_cast<std::uint8_t>(k);
      }
  }
  costs[1] = own + costs[BVH_WIDTH];
  // More places never cost more, so that opening pays from some number on.
  for (std::size_t places = 2; places <= BVH_WIDTH && !(costs[places] < costs[1]); ++places) {
    costs[places] = costs[1];
    choice.opens_from = static_cast<std::uint8_t>(places + 1);
  }
  return choice;
}

float BinaryBox::area() const {
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x * y + y * z + z * x;
}

Bvh collapse(BinaryTree tree, const std::vector<TriangleRecord>& triangles,
             const std::vector<SphereRecord>& spheres, const Bvh& beside) {
  Bvh out;
  if (tree.root == BVH_EMPTY) return out;
  std::vector<Branch> branches;
  out.root = Collapse(tree, triangles, &branches, out).visit(tree.root, 0);
  std::vector<Bvh> parts(branches.size());
  parallel_for(parts.size(), [&](std::size_t i) {
    parts[i].root = Collapse(tree, triangles, nullptr, parts[i]).visit(branches[i].code, kBranchLevel);
  });
  tbb::concurrent_vector<BinaryNode>().swap(tree.nodes);  // of millions of spheres the most memory of all
  const auto nodes = [](std::size_t sum, const Bvh& part) { return sum + part.nodes.size(); };
  out.nodes.reserve(std::accumulate(parts.begin(), parts.end(), out.nodes.size(), nodes) +
                    beside.nodes.size() + 1);
  out.triangles.reserve(triangles.size() + beside.triangles.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    out.nodes[branches[i].node].child[branches[i].child] = append_tree(parts[i], out);
    parts[i] = {};
  }
  out.sphere_source = std::move(tree.sphere_order);
  out.spheres.resize(out.sphere_source.size());
  parallel_for(
      out.spheres.size(), [&](std::size_t i) { out.spheres[i] = spheres[out.sphere_source[i]]; },
      kCopiedBlock);
  return out;
}

}  // namespace hybrid::stages
