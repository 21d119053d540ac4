#pragma once
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/simple_rings.hpp"

// A supercluster's contours as polygons on its plane.
namespace hybrid::stages {

// The contours with fewer vertices: those within `straighten` sample spacings of the line through the ones
// that stay are left out (Douglas and Peucker). As they are where that would make them cross.
std::vector<FlatRing> flat_rings(const RangeImage&, const Supercluster&, double straighten);

// Inside an odd number of the rings; points on an edge fall to one side or the other.
bool inside(const std::vector<FlatRing>& rings, const RingVertex& point);

// One face per outer ring, with the holes in it, scan frame; empty when they cannot be triangulated.
PolygonModel polygons_of(const std::vector<FlatRing>& rings);

}  // namespace hybrid::stages
