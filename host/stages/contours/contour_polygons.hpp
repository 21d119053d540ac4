#pragma once
#include <cstdint>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/contours/simple_rings.hpp"

// A supercluster's contours as polygons on its plane.
namespace hybrid::stages {

// The contours with fewer vertices: those within `straighten` sample spacings of the line through the ones
// that stay are left out (Douglas and Peucker), and of the smaller of two rings those that they share. As
// they are where that would make them cross.
std::vector<FlatRing> flat_rings(const RangeImage&, const Supercluster&, double straighten);

// Which points lie inside an odd number of the rings; points on an edge fall to one side or the other. For
// many points: a point meets only the edges of its own band of y, of some thousand.
class InsideRings {
 public:
  explicit InsideRings(const std::vector<FlatRing>& rings);
  bool operator()(const RingVertex& point) const;
  // Whether a side's own box meets the box, borders included.
  bool border_near(const RingVertex& low, const RingVertex& high) const;

 private:
  struct Edge {
    std::int64_t from_x, from_y, to_x, to_y;
  };
  std::size_t band(std::int64_t y) const { return static_cast<std::size_t>((y - low_y_) / band_nm_); }

  std::vector<Edge> edges_;
  std::int64_t low_y_ = 0, high_y_ = 0, band_nm_ = 1;
  std::vector<std::uint32_t> first_;    // of a band in of_band_; one more than bands
  std::vector<std::uint32_t> of_band_;  // edges, by band
};

// One face per outer ring, with the holes in it, scan frame; whether they can be triangulated is not said.
PolygonModel polygons_of(const std::vector<FlatRing>& rings);

}  // namespace hybrid::stages
