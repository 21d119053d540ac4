#pragma once
#include <vector>

#include "geometry/face_frame.hpp"
#include "geometry/polygon_model.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

// An opening of a wall that glass closes.
struct GlazedOpening {
  FaceFrame frame;    // of the wall's face, world frame
  Ring2 ring;         // face coordinates
  double pane_m = 0;  // how far behind the face the glass is
};

// A copy of a contour polygon.
struct OpeningContent {
  std::size_t face = 0;  // of the contours: what it is a copy of
  PolygonModel polygon;  // one face, world frame, front side as that face's
};

// What stands in openings where no scan has seen it: builders repeat windows, and their left sides on their
// right. The contour polygons (`contours`, world frame) between a wall's face and its glass, such as jambs,
// frames and mullions, stand in every opening of the same design, and, where its outline is symmetric,
// mirrored in the same opening and in those, too, unless scans know better (may_be_there). Those of the
// nearest opening first.
std::vector<OpeningContent> opening_contents(const ScanSight& sight, const PolygonModel& contours,
                                             const std::vector<GlazedOpening>& openings);

}  // namespace hybrid::stages
