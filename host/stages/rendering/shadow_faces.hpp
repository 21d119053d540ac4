#pragma once
#include <vector>

#include "geometry/polygon_model.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

// A part of a contour polygon's plane.
struct ShadowFace {
  std::size_t face = 0;  // of the contours
  PolygonModel polygon;  // one face, front side that face's
};

// What stands before a plane that no proxy face explains hides a part of it from the scan that shows it: a
// passer-by before a buttress, a column before a gallery's front. The plane goes on there where the hidden
// part lies between two seen ones, level or upright, or below a seen one down to the lowest place of an
// upright polygon, of another part of it in its plane, or of an upright one that it meets at a corner, for
// what is built stands on the ground, or beside a seen one up to a square corner with a contour or a face of
// `model`, where that stands before it as seen from the scan; no scan looks through it there, and hardly any
// of its border is seen through. A narrow hole in which no scan measured anything (dark paint, a door's iron
// band) is closed, too, also where a single beam in it returned from behind; not where only bars no wider
// than it part it from others. `contours`: world frame; `scan_of_face`: index into sight's scans. In the
// order of faces: same result for any number of threads.
std::vector<ShadowFace> shadow_faces(const ScanSight& sight, const PolygonModel& contours,
                                     const std::vector<std::size_t>& scan_of_face, const PolygonModel& model);

}  // namespace hybrid::stages
