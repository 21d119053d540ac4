#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "geometry/polygon_model.hpp"
#include "geometry/superclusters.hpp"
#include "stages/registration/automatic_scene.hpp"
#include "stages/registration/proxy_model.hpp"

namespace hybrid::stages {

struct FaceOffsetOptions {
  std::string solve =
      "auto";               // "auto": jointly with the pose where faces do not agree; "never": measure only
  double reach_m = 0.1;     // a face is at most this far off; what lies farther away is not on it
  double agree_m = 0.0015;  // faces that agree within this are right as they are
};
const std::vector<OptionRow<FaceOffsetOptions>>& face_offset_option_table();

// Where a scan's plane lies against the face that stands for it.
struct FaceOffset {
  std::uint32_t face = 0;  // index in the model
  std::string name;
  double offset_m = 0;      // along the face's normal, world: above 0 in front of the face, below 0 behind it
  double sigma_m = 0;       // of the samples about it: noise, unevenness, and what the face is tilted
  double pose_sigma_m = 0;  // standard deviation of the offset, for the pose is not exact (add_pose_sigma)
  double tilt_deg = 0;      // between face and plane
  double area_m2 = 0;       // of the plane on the face
  std::int64_t samples = 0;
  Vec3 normal = Vec3::UnitZ(), centre = Vec3::Zero();  // of the face; of the plane on it, world
};

struct FaceOffsets {
  bool agree = false;             // the faces are right as they are: most lie on their planes and hold a pose
  double disagreement_m = 0;      // robust standard deviation of the offsets, by area
  std::vector<FaceOffset> faces;  // largest area first
  std::string note{};             // why there are none, where the model is not of such faces
};

// What all faces have in common moves or turns the proxy as a whole: it is in the pose, and no scan can show
// it. For pose.json and the report.
inline constexpr const char* kUnobservable =
    "a shift or turn that all faces have in common cannot be seen by any scan: it is in the pose, not in the "
    "offsets";

// METHOD 6: the faces of an approximate proxy are off, each by an offset of its own. Tile ICP from the start,
// then pose and offsets together: the pose whose offsets have the least sum of squares over the area. On
// every face counts the plane that covers most of it, with what lies in one plane with it (a recess, a panel
// or a cupboard before the wall is another plane); a face much farther off than the others (beyond 3 robust
// standard deviations, none beyond 6) is not the plane's face and counts less. The start is kept along
// directions that the planes leave open, and its scale. A mesh of small faces (has_large_faces()) has no
// offsets: the start is returned.
Pose solve_face_offsets(const PlaneSegmentation& segmentation, const ScanEvidence& scan,
                        const ProxyModel& model, const Pose& start, const FaceOffsetOptions& options = {});

// The offsets under a pose. `agree`: planes on most of the area (80 %; or half, if they hold all six
// directions) lie on their faces within agree_m, tilt included.
FaceOffsets measure_face_offsets(const PlaneSegmentation& segmentation, const ScanEvidence& scan,
                                 const ProxyModel& model, const Pose& world_from_scan,
                                 const FaceOffsetOptions& options = {});

// Fills pose_sigma_m from a pose's covariance (Registration::covariance).
void add_pose_sigma(const std::array<double, 36>& covariance, FaceOffsets& offsets);

// "scan lies 12.0 mm behind, sigma 2.0 mm".
std::string offset_in_words(const FaceOffset& offset);

}  // namespace hybrid::stages
