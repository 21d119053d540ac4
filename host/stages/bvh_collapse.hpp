#pragma once
#include <tbb/concurrent_vector.h>

#include <array>
#include <cstdint>
#include <vector>

#include "stages/bvh.hpp"

namespace hybrid::stages {

struct BinaryBox {
  std::array<float, 3> low{INFINITY, INFINITY, INFINITY};
  std::array<float, 3> high{-INFINITY, -INFINITY, -INFINITY};

  void add(const std::array<float, 3>& l, const std::array<float, 3>& h);
  void add(const BinaryBox& box) { add(box.low, box.high); }
  float area() const;
};

// A node of the tree as the surface area heuristic makes it. Codes are those of shared/bvh_records.h; inner
// ones are places in `nodes` below, in no particular order, leaves point into `order`.
struct BinaryNode {
  std::array<BinaryBox, 2> boxes;
  std::array<std::uint32_t, 2> children;
};

struct BinaryTree {
  tbb::concurrent_vector<BinaryNode> nodes;
  std::vector<std::uint32_t> order;  // per place, the primitive's index in its input
  std::uint32_t root = BVH_EMPTY;
};

// As build_bvh (bvh.hpp), before it is pulled together.
BinaryTree build_binary_tree(const std::vector<TriangleRecord>& triangles,
                             const std::vector<SphereRecord>& spheres);

// Pulls binary nodes together into nodes of up to BVH_WIDTH children, always opening the child of the largest
// surface, and copies the primitives in the order of the leaves; depth first, so that the result does not
// depend on the order of the tree's nodes.
void collapse(const BinaryTree& tree, const std::vector<TriangleRecord>& triangles,
              const std::vector<SphereRecord>& spheres, Bvh& out);

}  // namespace hybrid::stages
