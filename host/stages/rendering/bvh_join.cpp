#include "stages/rendering/bvh_join.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace hybrid::stages {
namespace {

using Box = Eigen::AlignedBox3f;

Box box_of_leaf(std::uint32_t code, const Bvh& bvh) {
  Box box;
  const std::size_t first = code & BVH_FIRST_MASK;
  const std::size_t count = ((code >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1;
  for (std::size_t i = first; i < first + count; ++i) {
    if (code & BVH_SPHERES) {
      const SphereRecord& sphere = bvh.spheres[i];
      const Eigen::Array3f centre = Eigen::Map<const Eigen::Array3f>(sphere.centre);
      box.extend(Eigen::Vector3f(centre - sphere.radius)).extend(Eigen::Vector3f(centre + sphere.radius));
    } else {
      for (const float* corner : {bvh.triangles[i].a, bvh.triangles[i].b, bvh.triangles[i].c})
        box.extend(Eigen::Map<const Eigen::Vector3f>(corner));
    }
  }
  return box;
}

Box box_of(std::uint32_t code, const Bvh& bvh) {
  if (code & BVH_LEAF) return box_of_leaf(code, bvh);
  const BvhNode& node = bvh.nodes[code];
  Box box;
  for (std::size_t i = 0; i < BVH_WIDTH; ++i)
    if (node.child[i] != BVH_EMPTY)
      box.extend(Eigen::Vector3f(node.low_x[i], node.low_y[i], node.low_z[i]))
          .extend(Eigen::Vector3f(node.high_x[i], node.high_y[i], node.high_z[i]));
  return box;
}

}  // namespace

BvhNode empty_node() {
  BvhNode node;
  for (float* low : {node.low_x, node.low_y, node.low_z}) std::fill(low, low + BVH_WIDTH, BVH_NOWHERE);
  for (float* high : {node.high_x, node.high_y, node.high_z}) std::fill(high, high + BVH_WIDTH, -BVH_NOWHERE);
  std::fill(node.child, node.child + BVH_WIDTH, BVH_EMPTY);
  return node;
}

std::uint32_t append_tree(const Bvh& tree, Bvh& out) {
  const auto nodes = static_cast<std::uint32_t>(out.nodes.size()),
             triangles = static_cast<std::uint32_t>(out.triangles.size());
  const auto moved = [&](std::uint32_t code) {
    if (code == BVH_EMPTY || (code & BVH_LEAF && code & BVH_SPHERES)) return code;
    return code + (code & BVH_LEAF ? triangles : nodes);
  };
  for (BvhNode node : tree.nodes) {
    for (std::uint32_t& child : node.child) child = moved(child);
    out.nodes.push_back(node);
  }
  out.triangles.insert(out.triangles.end(), tree.triangles.begin(), tree.triangles.end());
  return moved(tree.root);
}

std::uint32_t join_trees(std::uint32_t one, std::uint32_t other, Bvh& bvh) {
  if (one == BVH_EMPTY || other == BVH_EMPTY) return one == BVH_EMPTY ? other : one;
  BvhNode node = empty_node();
  std::size_t i = 0;
  for (const std::uint32_t code : {one, other}) {
    const Box box = box_of(code, bvh);
    node.low_x[i] = box.min().x(), node.low_y[i] = box.min().y(), node.low_z[i] = box.min().z();
    node.high_x[i] = box.max().x(), node.high_y[i] = box.max().y(), node.high_z[i] = box.max().z();
    node.child[i++] = code;
  }
  bvh.nodes.push_back(node);
  return static_cast<std::uint32_t>(bvh.nodes.size() - 1);
}

}  // namespace hybrid::stages
