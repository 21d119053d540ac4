#pragma once
#include <array>
#include <vector>

#include "shared/params_closest_point.h"
#include "shared/proxy_tree_records.h"
#include "stages/rendering/bvh_collapse.hpp"

namespace hybrid::stages {

// The model's triangles in a tree of boxes as closest_point_tree traverses it.
struct ProxyTree {
  std::vector<ProxyTriangle> triangles;  // in the order of the leaves
  std::vector<ProxyNode> nodes;          // depth first; empty when the root is a leaf
  std::uint32_t root = BVH_EMPTY;
};

// What of the tree does not depend on where its boxes' origin lies.
struct ProxyTreePlan {
  std::vector<std::uint32_t> order;                    // per place of a leaf, the triangle's index
  std::vector<std::array<std::uint32_t, 2>> children;  // per node, as ProxyNode has them
  std::uint32_t root = BVH_EMPTY;
};
ProxyTreePlan plan_proxy_tree(const BinaryTree& tree);

// Boxes hold all that the kernel may compute as a triangle's closest point, rounding of slivers and of faces
// that are not quite flat included, for triangles within about 10 km of the local origin. The same tree for
// any number of threads.
ProxyTree make_proxy_tree(const std::vector<ProxyTriangle>& triangles);
// The same by a plan, of triangles in its order.
ProxyTree make_proxy_tree(const ProxyTreePlan& plan, std::vector<ProxyTriangle> ordered);

}  // namespace hybrid::stages
