#pragma once
#include "score/measure/joined_scan.hpp"

namespace score {

// True planes with one equation (normals within 1e-6, offsets within 0.01 mm) are pieces of one geometric
// plane: the seats of ten pews, a wall on both sides of a pillar. A result may call them one plane or
// several. Where one region holds more than half of the samples of several of them they become one plane,
// under the smallest id; pieces that the result keeps apart stay apart.
void join_coplanar_pieces(const std::map<std::uint32_t, TruePlane>& planes, JoinedScan& scan);

}  // namespace score
