#pragma once
#include <cstdint>
#include <vector>

#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// A ring on its supercluster's plane. The plane coordinates are whole nanometres, so that every test on them
// is exact in 128-bit integers.
struct RingVertex {
  std::int64_t x = 0, y = 0;
  Vec3 point = Vec3::Zero();
};
struct FlatRing {
  std::vector<RingVertex> vertices;
  bool outer = true;
};

// Coordinates about the plane's foot point, right-handed as seen from the normal's side.
class PlaneCoordinates {
 public:
  explicit PlaneCoordinates(const Plane& plane);
  RingVertex vertex(const Vec3& point) const;

 private:
  Vec3 origin_, axis_x_, axis_y_;
};

// Twice the area in nm2, positive for counter-clockwise; exact up to rounding to double.
double signed_area2(const FlatRing& ring);

// True when no two edges of the rings meet, except neighbours in their common vertex and different rings in
// equal vertices.
bool are_simple(const std::vector<FlatRing>& rings);

// The rings, in order, of which an edge meets another of theirs or another ring's in that sense, or a vertex
// comes nearer to such an edge than `reach_nm`: points moved onto one line lie on it but for rounding, so
// that edges that lie over each other need not meet.
std::vector<std::size_t> touching_rings(const std::vector<FlatRing>& rings, std::int64_t reach_nm);

// Of rings that were `before`, and simple, and have moved since, those become as they were that touch
// themselves or another one, until none does.
void restore_touching(std::vector<FlatRing>& rings, const std::vector<FlatRing>& before);

// Drops the vertices at which rings cross themselves or each other, until none does: the shorter loop a
// crossing cuts off, or the ends of the crossing edges. A ring that would lose more than a quarter of its
// vertices is given up: an outer one becomes its convex hull, an inner one is dropped. Rings whose area
// vanishes or turns over are dropped. Afterwards are_simple(rings) holds.
void make_simple(std::vector<FlatRing>& rings);

}  // namespace hybrid::stages
