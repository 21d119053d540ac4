#pragma once
#include <vector>

#include "stages/planes/plane_moments.hpp"
#include "stages/planes/square_grid.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::stages {

// A connected (or, after merging, coplanar) set of squares on its way to a supercluster.
struct PlaneRegion {
  PlaneMoments moments;  // of its squares' inliers
  PlaneFit fit;
  std::vector<std::uint32_t> squares;  // in the order of growth
  bool curved = false;                 // a facet of a cylinder, vault, ...: no supercluster
  bool facet = false;                  // curved because it meets its neighbours in shallow creases
  bool small = false;  // from leftover samples (recover_small_planes): owns none of its squares
  bool few = false;    // lost its squares for being too few, and for nothing else
};

struct PlaneRegions {
  std::vector<PlaneRegion> regions;
  std::vector<std::uint32_t> of_square;  // index + 1 into regions, 0 = none
};

// Costs of square_links: [2i] right, [2i + 1] lower neighbour, below 0 = no link.
using SquareLinks = std::vector<float>;

// METHOD 3, region growing over linked squares from the flattest neighbourhoods outwards. Chains of links
// walk around cylinders; therefore each square must also agree with the region's own plane, within what the
// covariances of both allow.
PlaneRegions grow_regions(const SquarePlanes& squares, const SquareGrid& grid, const SquareLinks& links,
                          const SuperclusterOptions& options);

// The winner takes the loser's squares, which stays behind empty. By index + 1.
void join_regions(PlaneRegions& regions, std::uint32_t winner, std::uint32_t loser);

// Moments of a planar square's inliers.
PlaneMoments square_moments(const SquareRecord& square);
inline Vec3 square_normal(const SquareRecord& square) {
  return {square.normal[0], square.normal[1], square.normal[2]};
}
inline Vec3 square_centroid(const SquareRecord& square) {
  return {square.centroid[0], square.centroid[1], square.centroid[2]};
}

}  // namespace hybrid::stages
