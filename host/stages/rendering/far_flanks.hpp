#pragma once
#include <array>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

// A quadrilateral behind the border of a contour polygon.
struct FarFlank {
  std::size_t face = 0;         // of the contours
  std::array<Vec3, 4> corners;  // in order, front side outwards
};

// What juts out has two flanks, of which a scan often sees one: a buttress, a pew's end, a chest. Where a
// polygon has a seen flank (a polygon that leads straight back from one of its borders), its opposite border,
// if a scan sees past it, has one too, as deep, where no scan knows what is there. `contours`: world frame;
// the first `seen` faces were seen, those that follow close what was not. Where a face is already there is no
// flank. In the order of faces: same result for any number of threads.
std::vector<FarFlank> far_flanks(const ScanSight& sight, const PolygonModel& contours, std::size_t seen);

}  // namespace hybrid::stages
