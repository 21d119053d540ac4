#pragma once
#include <string>
#include <vector>

#include "stages/registration/automatic.hpp"

namespace hybrid::stages {

// What scans see of each face of a model, by its index: planar area on its front, and on its back. Exports of
// modelling programs turn some faces, or all, the wrong way; ICP, lines of sight and photographs know fronts.
struct FaceSides {
  std::vector<double> front_m2, back_m2;

  FaceSides& operator+=(const FaceSides& other);
};

// A sample within `tolerance_m` of a face and turned by at most 25 degrees from its normal lies on its front;
// one of no front, but of a face's back, lies on that.
FaceSides face_sides(const ScanEvidence& scan, const ProxyModel& model, const Pose& world_from_scan,
                     double tolerance_m);

// Faces of which scans see `least_m2` from behind, and at most a quarter as much from the front; most first.
std::vector<std::uint32_t> turned_faces(const FaceSides& sides, const std::vector<double>& least_m2);

std::vector<std::string> names_of_faces(const PolygonModel& model, const std::vector<std::uint32_t>& faces);

// Why a pose that is contradicted may be right all the same: with faces that are seen from behind turned
// round, at least `least_support` of the planar area would lie on faces under it. Names them; "" when it is
// not so.
std::string diagnose_turned_faces(const ScanEvidence& scan, const ProxyModel& model, const Pose& start,
                                  const AutomaticOptions& options);

}  // namespace hybrid::stages
