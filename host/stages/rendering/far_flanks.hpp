#pragma once
#include <array>
#include <limits>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

// A quadrilateral behind the border of a contour polygon.
struct FarFlank {
  std::size_t face = 0;         // of the contours
  std::array<Vec3, 4> corners;  // in order, front side outwards
};

inline constexpr std::size_t kPartOfNone = std::numeric_limits<std::size_t>::max();

// What juts out has two flanks, of which a scan often sees one: a buttress, a pew's end, a chest. Where a
// polygon has a seen flank (a polygon that leads straight back from one of its borders), its opposite border,
// if a scan sees past it, has one too, as deep, where no scan knows what is there; none deeper than twice the
// polygon's width. `contours`: world frame; `part_of`: per face itself where it was seen, the seen one that
// goes on with it (shadow_faces.hpp), or kPartOfNone. Where a face is already there is no flank. In the order
// of faces: same result for any number of threads.
std::vector<FarFlank> far_flanks(const ScanSight& sight, const PolygonModel& contours,
                                 const std::vector<std::size_t>& part_of);

}  // namespace hybrid::stages
