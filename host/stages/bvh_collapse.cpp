#include "stages/bvh_collapse.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

struct Child {
  BinaryBox box;
  std::uint32_t code;
};

class Collapse {
 public:
  Collapse(const BinaryTree& tree, const std::vector<TriangleRecord>& triangles,
           const std::vector<SphereRecord>& spheres, Bvh& out)
      : tree_(tree), triangles_(triangles), spheres_(spheres), out_(out) {}

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
      const std::uint32_t final_code = visit(children[i].code, level + 1);
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
    const auto add = [&](std::uint32_t of, std::size_t at) {
      const BinaryNode& node = tree_.nodes[of];
      const Child left{node.boxes[0], node.children[0]}, right{node.boxes[1], node.children[1]};
      if (at < children.size()) {
        children[at] = left;
      } else {
        children.push_back(left);
      }
      children.push_back(right);
    };
    add(code, 0);
    while (children.size() < width) {
      std::size_t largest = children.size();
      for (std::size_t i = 0; i < children.size(); ++i)
        if (!(children[i].code & BVH_LEAF) &&
            (largest == children.size() || children[i].box.area() > children[largest].box.area()))
          largest = i;
      if (largest == children.size()) break;
      add(children[largest].code, largest);
    }
    return children;
  }

  static BvhNode empty_node() {
    BvhNode node;
    for (float* low : {node.low_x, node.low_y, node.low_z}) std::fill(low, low + BVH_WIDTH, BVH_NOWHERE);
    for (float* high : {node.high_x, node.high_y, node.high_z})
      std::fill(high, high + BVH_WIDTH, -BVH_NOWHERE);
    std::fill(node.child, node.child + BVH_WIDTH, BVH_EMPTY);
    return node;
  }

  std::uint32_t leaf(std::uint32_t code) {
    const std::size_t begin = code & BVH_FIRST_MASK;
    const std::size_t count = ((code >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1;
    const bool sphere = (code & BVH_SPHERES) != 0;
    const std::size_t first = sphere ? out_.spheres.size() : out_.triangles.size();
    for (std::size_t i = begin; i < begin + count; ++i) {
      const std::uint32_t index = tree_.order[i];
      if (sphere) {
        out_.spheres.push_back(spheres_[index]);
        out_.sphere_source.push_back(index);
      } else {
        out_.triangles.push_back(triangles_[index]);
      }
    }
    return (code & ~BVH_FIRST_MASK) | static_cast<std::uint32_t>(first);
  }

  const BinaryTree& tree_;
  const std::vector<TriangleRecord>& triangles_;
  const std::vector<SphereRecord>& spheres_;
  Bvh& out_;
};

}  // namespace

void BinaryBox::add(const std::array<float, 3>& l, const std::array<float, 3>& h) {
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], l[k]);
    high[k] = std::max(high[k], h[k]);
  }
}

float BinaryBox::area() const {
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x < 0 ? 0 : x * y + y * z + z * x;
}

void collapse(const BinaryTree& tree, const std::vector<TriangleRecord>& triangles,
              const std::vector<SphereRecord>& spheres, Bvh& out) {
  out.triangles.reserve(triangles.size());
  out.spheres.reserve(spheres.size());
  out.sphere_source.reserve(spheres.size());
  out.root = Collapse(tree, triangles, spheres, out).visit(tree.root, 0);
}

}  // namespace hybrid::stages
