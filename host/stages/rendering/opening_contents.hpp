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
  enum class Kind { alike, back };
  Kind kind = Kind::alike;
  std::size_t face = 0;  // of the contours: what it is a copy of
  PolygonModel polygon;  // one face, world frame
};

// What stands in openings where no scan has seen it: builders repeat windows, and their left sides on their
// right. The contour polygons (`contours`, world frame) between a wall's face and its glass, such as jambs,
// frames and mullions, stand in every opening of the same design, and, where its outline is symmetric,
// mirrored in the same opening and in those, too, unless scans know better (may_be_there); those of the
// nearest opening first. A frame that is seen before the glass, and whose sides are seen through it to go on
// behind it, has a back where they end, in every opening of the design.
std::vector<OpeningContent> opening_contents(const ScanSight& sight, const PolygonModel& contours,
                                             const std::vector<GlazedOpening>& openings);

}  // namespace hybrid::stages
