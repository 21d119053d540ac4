#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/export/export_options.hpp"
#include "io/scene/scene_file.hpp"
#include "stages/contours/contour_faces.hpp"
#include "stages/contours/contours.hpp"
#include "stages/editing/displacement.hpp"
#include "stages/editing/openings.hpp"
#include "stages/planes/decimate.hpp"
#include "stages/planes/square_planes.hpp"
#include "stages/planes/superclusters.hpp"
#include "stages/registration/automatic.hpp"
#include "stages/registration/face_offsets.hpp"
#include "stages/registration/icp.hpp"
#include "stages/registration/joint_poses.hpp"
#include "stages/registration/landmarks.hpp"
#include "stages/rendering/coverage.hpp"
#include "stages/rendering/render.hpp"
#include "stages/scan/resample.hpp"
#include "stages/scan/stray_samples.hpp"

namespace hybrid::batch {

// The options of one run: defaults, then the scene file's sections, then the command line: --set, then tile,
// seed and square.
struct StageOptions {
  bool auto_square = true;  // square = "auto": the side follows from noise and sample spacing
  bool lossless = false;    // also write every sample exactly, the discarded ones by their planes
  stages::ResampleOptions resample;
  stages::SquarePlaneOptions squares;
  stages::SuperclusterOptions superclusters;
  stages::ContourOptions contours;
  stages::DecimateOptions decimate;
  stages::StrayOptions stray;
  stages::ContourFaceOptions contour_faces;
  stages::LandmarkOptions landmarks;
  stages::IcpOptions icp;
  stages::AutomaticOptions alignment;
  stages::FaceOffsetOptions faces;
  bool joint = true;  // refine the poses of all scans together
  stages::JointOptions joint_poses;
  // Which scans are aligned without a start: those with neither landmarks nor pose; all but those with a
  // pose, landmarks deciding where it abstains; none.
  std::string automatic = "missing";  // "missing" | "first" | "never"
  // Formats in which `register` writes the registered scans (registered_scans.hpp); "" = none.
  std::string write_registered{};
  double explain_m = 0.05;  // a planar sample within this of a compatible face is explained by it
  stages::OpeningOptions edit;
  stages::DisplacementOptions displacement;  // of [edit], too
  stages::CoverageOptions coverage;          // of [render]
  stages::RenderOptions render;
  ExportOptions exporting;  // [export]

  void set_tile(int tile);
  void set_seed(int seed);
  // "auto" or 3..16. Throws ErrorKind::input.
  void set_square(const OptionValue& value);
  // "SECTION.KEY=VALUE" as --set takes it; SECTION is planes, register, edit, render or export, KEY and VALUE
  // as in the scene file. Throws ErrorKind::input naming the key, what was expected and what was found.
  void apply(const std::string& assignment);
  // The same, of the command line: throws ErrorKind::usage naming the assignment, too.
  void set(const std::string& assignment);
};

// Applies [planes], [register], [edit], [render] and [export], then the assignments of --set. Unknown keys,
// wrong types and values out of range throw ErrorKind::input naming file, line and key (ErrorKind::usage for
// --set).
StageOptions read_stage_options(const io::SceneFile& scene, const std::vector<std::string>& assignments = {});

// Whether a run without --only exports: where the scene file has an [export], or an assignment one of its
// keys.
bool asks_for_export(const io::SceneFile& scene, const std::vector<std::string>& assignments);

// All options as they were used, for summary.json.
nlohmann::ordered_json describe(const StageOptions& options);

// A key of one of these sections, for people.
struct OptionNote {
  std::string section, key;
  nlohmann::ordered_json value;  // by default; null where that is another key's
  std::string unit;
  bool is_number = false;
  double least = 0, most = 0;  // of numbers
  std::vector<std::string> choices;
  std::string help;
};
std::vector<std::string> option_sections();
// Of these sections, or of all where none is named; lists of edits are no options.
std::vector<OptionNote> option_notes(const std::vector<std::string>& of_sections = {});

}  // namespace hybrid::batch
