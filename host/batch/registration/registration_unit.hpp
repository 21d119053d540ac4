#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "batch/registration/residuals.hpp"
#include "batch/scan_unit.hpp"
#include "io/scene/scene_file.hpp"
#include "stages/registration/distances_to_scans.hpp"
#include "stages/registration/face_offsets.hpp"
#include "stages/registration/scan_icp.hpp"
#include "stages/registration/slide_on_scans.hpp"

namespace hybrid::batch {

// Share of a scan's wall samples near the proxy: wall samples are measured samples of superclusters whose
// plane is within 30 degrees of vertical in the world (floors and ceilings hide horizontal errors).
struct WallShare {
  std::int64_t samples = 0;
  double within_5cm = 0, within_10cm = 0;
};

// How far from the model samples of no supercluster are measured; more than pictures show and than counts as
// lying on a face.
constexpr double kFreeReach_m = 0.5;

// How a scan lies on the other scans of its scene, planar samples and the others.
struct OnScans {
  // ICP began at: "given" | "recorded" (in the scan's file) | "coordinates" (of the file) | "automatic" (a
  // hypothesis of the alignment to the model or to other scans) | "island" (the place of its island on all
  // placed scans); "" = no ICP
  std::string start;
  stages::ScanIcp icp;
  std::vector<std::string> others;     // whose figures icp.others are
  const std::string& nearest() const;  // of the others; there is one
};

// Where the model leaves a scan free to slide along one direction: what the others made of that.
struct OnSlide {
  stages::SlideOnScans found;
  std::vector<std::string> others;  // found.on_other_m2 are of
};

// The scans that a scan without a pose hangs together with, which have none either.
struct Island {
  std::string frame;  // one of them, or itself
  Pose frame_from_scan;
  std::vector<std::string> others;
  std::optional<OnScans> on_scans;
};

// What scans say of the poses in their files. Those that ICP on one beside them leaves where the files have
// both agree, those that it moves, or that are contradicted there, differ.
struct RecordedWord {
  std::size_t agree = 0, differ = 0;
  double farthest_m = 0, farthest_rad = 0;  // that ICP moved one that agrees

  // Then the files' poses are worth something where scans do not tell, too.
  bool is_trusted() const;
  // As Registration::covariance, of such a pose.
  std::array<double, 36> covariance(const Pose& world_from_scan) const;
};

// A pose that is the one in the scan's file, beside that of another scan, or that ICP found from there.
struct ByRecorded {
  std::string by;
  std::optional<RecordedWord> word;  // where nothing else holds it
};

// Where a scan without a pose may stand; so many at most are said.
inline constexpr std::size_t kMostPlaces = 4;
struct PossiblePlace {
  Pose world_from_scan;
  std::string words;  // what speaks for it, and how it differs from the first
};

struct ScanRegistration {
  // "landmarks" | "automatic" | "given" | "recorded" (from the pose in its file, beside that of another
  // scan); with other scans: "neighbour", "scan-icp" (from a given or recorded pose), "frame" (the first,
  // without a model), "coordinates"
  std::string how;
  bool fixed = false;
  bool abstained = false;             // there is no pose: the automatic alignment abstained, or `refusal`
  std::string refusal;                // why the landmarks, or the pose that ICP found, place nothing
  bool no_start = false;              // `refusal` is that nothing gives it one but the pose in its file
  std::vector<std::string> warnings;  // what a person should look at: pose.json, summary.json, report
  Pose start;                         // from landmarks, the automatic alignment or the scene file
  std::optional<stages::LandmarkFit> landmarks;
  std::optional<stages::AutomaticAlignment> automatic;  // to the model
  stages::Registration icp;                             // world_from_scan: the result
  // Of a pose that ICP found from the scene's pose or landmarks, and that was judged: under it.
  std::optional<stages::SightShares> planar_area;
  // Planes and lines of sight, for what follows: face offsets, neighbours, joint refinement.
  stages::ScanEvidence evidence;
  std::optional<stages::FaceOffsets> faces;  // nothing without a model
  bool solved_with_faces = false;            // the pose was, as the faces do not agree
  WallShare wall_before, wall_after;
  // Per node, to the closest compatible face, under the final pose, below 0 behind it; NaN where not
  // measured, or outside superclusters and not within kFreeReach_m.
  std::vector<float> signed_distance_m;
  std::optional<stages::DistancesToScans> to_scans;  // without a model, where other scans have a pose
  ResidualHistogram residuals;                       // of the one or the other
  // Aligned to another scan, not to the model: to which, and what spoke for it; why not, where that
  // abstained.
  std::string carried_by, neighbour_reason;
  std::optional<stages::AutomaticAlignment> neighbour;
  bool unjudged =
      false;  // a given or recorded pose that neither the model nor another scan tells anything of
  std::optional<ByRecorded> recorded;
  std::vector<PossiblePlace> places;  // of a scan without a pose, for which most speaks first
  std::optional<Island> island;       // without a model, of a scan without a pose
  std::optional<OnScans> on_scans;    // without a model, where another scan has a pose
  nlohmann::ordered_json written;     // files of the registered scan (registered_scans.hpp), or null
  std::optional<OnSlide> slide;       // where other scans have a pose
  bool scale_of_others = false;       // share_scale()
  bool held_by_model = true;          // by what it sees of the model; else by its neighbours alone
  const Pose& world_from_scan() const { return icp.world_from_scan; }
  // Its place along one direction is as its start has it: neither the model nor other scans say.
  bool slides() const {
    return !fixed && held_by_model && icp.only_slide && !(slide && slide->found.accepted);
  }
};

// METHOD 5 to 7: landmarks, the scene's pose or the automatic alignment give the start; tile ICP, then ICP on
// the planar samples the result, or, where the proxy's faces are off, pose and face offsets together; a pose
// with fixed = true is final. Landmarks that do not belong together place nothing: then the planes alone do,
// where [register] automatic lets them. Landmarks that place nothing in the scan's frame may be in the file's
// coordinates, by the pose in it; then they are taken so, with a warning. A scan whose automatic alignment
// abstains and that has no landmarks, or such ones, is returned without a pose, and so is one whose planes
// contradict what ICP found from landmarks or the scene's pose (stages/registration/pose_evidence.hpp), or
// that it led farther than 2 m or 40 degrees from there. Throws ErrorKind::input when neither landmarks nor a
// pose are given, nor one in the file, and [register] automatic = "never".
ScanRegistration find_pose(device::Queue& queue, const io::SceneScan& entry, const stages::ProxyModel& model,
                           const StageOptions& options, const ScanProduct& product, Progress& progress);

// To the log and to the registration's warnings.
void warn(const ScanProduct& product, const std::string& warning, ScanRegistration& registration);

// Of a scan that abstained: why it has no pose, as pose.json and summary.json say.
std::string reason_of(const ScanRegistration& abstained);

// From result.start, as find_pose does: icp, faces, solved_with_faces, held_by_model.
void refine_to_model(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                     const ScanProduct& product, ScanRegistration& result);

// What is said of a pose that was found or changed otherwise (joint refinement, a neighbour): covariance,
// overlap, face offsets.
void assess(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
            const ScanProduct& product, const Pose& pose, ScanRegistration& registration);

// Under the final pose: residuals; marks the planar samples that a proxy face explains, turns superclusters
// without a face into their contour polygons and gives the other samples back (METHOD 4):
// product.decimation and contour_faces change.
void finish_registration(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                         ScanProduct& product, ScanRegistration& registration, Progress& progress);

// The distances of `residuals`, if there are any, and what they are to: "model" | "scans".
struct RegisteredNodes {
  ResidualNodes nodes;
  std::string to;
};
std::optional<RegisteredNodes> residual_nodes(const ScanProduct& product,
                                              const ScanRegistration& registration);

// pose.json and residuals.png.
void write_pose_outputs(const std::filesystem::path& folder, const ScanProduct& product,
                        const ScanRegistration& registration);

}  // namespace hybrid::batch
