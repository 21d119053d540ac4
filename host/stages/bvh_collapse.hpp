#pragma once
#include <tbb/concurrent_vector.h>

#include <array>
#include <cstdint>
#include <vector>

#include "stages/bvh.hpp"

namespace hybrid::stages {

struct BinaryBox {
  std::array<float, 3> low, high;
  float area() const;
};

// A node of the tree as the surface area heuristic makes it. Codes are those of shared/bvh_records.h; inner
// ones are places in `nodes` below, in no particular order, leaves point into one of the orders.
struct BinaryNode {
  std::array<BinaryBox, 2> boxes;
  std::array<std::uint32_t, 2> children;
};

struct BinaryTree {
  tbb::concurrent_vector<BinaryNode> nodes;
  // Per place that leaves of either kind point to, the primitive's index in its input.
  std::vector<std::uint32_t> triangle_order, sphere_order;
  std::uint32_t root = BVH_EMPTY;
};

// As build_bvh (bvh.hpp), before it is pulled together.
BinaryTree build_binary_tree(const std::vector<TriangleRecord>& triangles,
                             const std::vector<SphereRecord>& spheres);

// Pulls binary nodes together into nodes of up to BVH_WIDTH children, always opening the child of the largest
// surface. Nodes lie depth first, the uppermost ones and then each subtree below them, so that the result
// does not depend on the order of the tree's nodes; triangles lie in the order of the nodes' leaves, spheres
// in the tree's.
Bvh collapse(BinaryTree tree, const std::vector<TriangleRecord>& triangles,
             const std::vector<SphereRecord>& spheres);

}  // namespace hybrid::stages
