#pragma once
#include <cstdint>

#include "stages/rendering/bvh.hpp"

namespace hybrid::stages {

// A node without children.
BvhNode empty_node();

// Puts the nodes and triangles of `tree` behind those of `out`; leaves of spheres keep pointing into those of
// `out`. Returns the code of its root there.
std::uint32_t append_tree(const Bvh& tree, Bvh& out);

// The code of a root above two trees of `bvh`, of which each keeps its own: rays choose what they meet.
std::uint32_t join_trees(std::uint32_t one, std::uint32_t other, Bvh& bvh);

}  // namespace hybrid::stages
