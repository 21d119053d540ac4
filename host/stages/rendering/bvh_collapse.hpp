#pragma once
#include <tbb/concurrent_vector.h>

#include <array>
#include <cstdint>
#include <vector>

#include "stages/rendering/bvh.hpp"

namespace hybrid::stages {

struct BinaryBox {
  std::array<float, 3> low, high;
  float area() const;
};

// Which binary nodes become wide ones so that rays cost least (dynamic programming: Ylitie, Karras, Laine
// 2017). What a subtree costs that may take k places among a wide node's children, k = 1..BVH_WIDTH: with one
// place it is a leaf or a wide node of its own.
using PlaceCosts = std::array<float, BVH_WIDTH + 1>;

// How a binary node shares out its places.
struct PlaceChoice {
  std::uint8_t opens_from = 2;                     // with fewer places it is a node of its own
  std::array<std::uint8_t, BVH_WIDTH + 1> left{};  // per number of places, those of its left child

  // The best for children of these costs; `own`: of a wide node alone. `costs`: of the whole.
  static PlaceChoice best(const PlaceCosts& left, const PlaceCosts& right, float own, PlaceCosts& costs);
};

// A node of the tree as the surface area heuristic makes it. Codes are those of shared/bvh_records.h; inner
// ones are places in `nodes` below, in no particular order, leaves point into one of the orders.
struct BinaryNode {
  std::array<BinaryBox, 2> boxes;
  std::array<std::uint32_t, 2> children;
  PlaceChoice choice;
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

// Pulls binary nodes together into nodes of up to BVH_WIDTH children as their choices say. Nodes lie depth
// first, the uppermost ones and then each subtree below them, so that the result does not depend on the order
// of the tree's nodes; triangles lie in the order of the nodes' leaves, spheres in the tree's. `beside`: a
// tree that there is room for, to be joined (bvh_join.hpp).
Bvh collapse(BinaryTree tree, const std::vector<TriangleRecord>& triangles,
             const std::vector<SphereRecord>& spheres, const Bvh& beside = {});

}  // namespace hybrid::stages
