#pragma once
#include <vector>

#include "geometry/face_frame.hpp"

namespace hybrid::stages {

// METHOD 9 (paper 2.4): the proxy with polygons removed and holes cut.

// The model without the marked faces (one mark per face). Vertices stay, so that their indices do. Throws
// ErrorKind::input when no face would remain.
PolygonModel without_faces(const PolygonModel& model, const std::vector<bool>& removed);

// Cuts a hole into a face; `ring` in the face's coordinates, either orientation. Vertices on the outline or
// up to `slack_m` beyond it move inside, so that a door may stand on the floor's edge. Throws
// ErrorKind::input telling what is wrong: fewer than three vertices, no area, a border that crosses itself,
// leaves the face, or meets another hole.
inline constexpr double kHoleSlack_m = 0.005, kHoleMargin_m = 0.001;
void cut_hole(PolygonModel& model, std::size_t face, Ring2 ring, double slack_m = kHoleSlack_m);

// World points of a face's plane in its coordinates. Throws ErrorKind::input naming a point farther than
// `tolerance_m` from the plane.
Ring2 ring_on_face(const FaceFrame& frame, const std::vector<Vec3>& points, double tolerance_m = 0.05);

}  // namespace hybrid::stages
