#pragma once
#include <array>
#include <vector>

#include "stages/plane_regions.hpp"

namespace hybrid::stages {

// Marks (and never unmarks) the regions that are facets of curved surfaces (columns, vaults): chains of links
// and the tolerance for waviness let a strip of a cylinder pass as a plane. A region is curved when
// - a quadratic height field over its plane fits significantly better and bends more than min_curvature, or
// - more than max_crease_share of its rim is in continuous contact with planar squares that, on the mean,
// bend
//   away from it (or towards it) by 2.5 to 30 degrees: the next facets. Only narrow regions are asked.
//   Contact with a region many times larger does not count: that is a wall with a shallow kink; nor do
//   squares that straddle a small step or a corner.
void mark_curved_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                         const SuperclusterOptions& options, PlaneRegions& regions);

// A quadratic height field over (a, b, height) fits significantly better than a plane and bends more than
// min_curvature, 1/m. False when the samples are too few or in too few lines to tell (can_bend).
bool can_bend(const std::vector<Vec3>& heights);
bool bends(const std::vector<Vec3>& heights, double min_curvature);

// Heights of a plane's samples over it, as (a, b, height). At its rim a plane may hold the first samples
// beyond an edge, which would bend a narrow strip.
struct PlaneHeights {
  std::vector<Vec3> all;
  std::vector<Vec3> inner;                   // whose four neighbours on the grid are the plane's too
  std::array<std::vector<Vec3>, 4> trimmed;  // that have a neighbour of the plane's on that side

  // `neighbours`: the plane holds the node to the right, below, left, above.
  void add(const Vec3& height, const std::array<bool, 4>& neighbours);
  // All bend, and whatever is left without the outermost samples of one side, or of all, bends as well, as
  // far as it can show that.
  bool bend(double min_curvature) const;
};

}  // namespace hybrid::stages
