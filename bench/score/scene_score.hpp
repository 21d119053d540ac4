#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "score/measure/bleeding.hpp"
#include "score/measure/boundary.hpp"
#include "score/measure/common_fit.hpp"
#include "score/measure/cylinders.hpp"
#include "score/measure/decimation.hpp"
#include "score/measure/labels.hpp"
#include "score/measure/normals.hpp"
#include "score/measure/openings.hpp"
#include "score/measure/picture_quality.hpp"
#include "score/measure/plane_list.hpp"
#include "score/measure/planes_hoover.hpp"
#include "score/measure/poses.hpp"

namespace score {

struct ScoreOptions {
  std::int64_t min_samples = 100;  // planes with fewer are not counted
  PoseLimits limits;
  std::string scan;        // only this scan; empty: all
  bool decimation = true;  // measured, where the results hold it
  bool list_planes = false;
};

struct PlaneScore {
  std::int64_t input_samples = 0, measured = 0;
  LabelScore labels;
  std::vector<HooverScore> hoover;  // one per kHooverOverlaps
  std::string normals_from;         // "planes.json", "fit to the labelled samples" or why there are none
  BoundaryScore boundary;
  std::vector<PlaneRow> list;                  // where it is asked for
  std::map<std::uint32_t, std::string> names;  // of its planes, as the truth has them
  std::optional<NormalScore> normals;          // where truth and result have ranges and points
};

// What is not in the results is absent.
struct ScanScore {
  std::string id;
  std::optional<PlaneScore> planes;
  std::optional<PoseScore> pose;
  std::optional<DecimationScore> decimation;
  std::optional<CylinderScore> cylinders;
};

struct ViewScore {
  std::string name, against;  // the truth's picture or the photograph that was left out
  std::int64_t pixels = 0;
  PictureQuality quality;
  BleedingScore bleeding;
};

struct SceneScore {
  std::string title;
  std::vector<ScanScore> scans;
  std::string frame;                    // the scan on whose true pose all poses are laid first; "": none
  std::optional<CommonFit> common_fit;  // of the accepted poses, where there are two and more
  std::vector<ViewScore> views;
  std::optional<OpeningScore> openings;
  std::vector<std::string> absent;  // measures without results, for people
};

// Everything DIR holds that the truth speaks of. Throws InputError: a part of the truth missing, a folder
// without any result of this scene, damaged files, results of another scene or seed.
SceneScore score_scene(const std::filesystem::path& truth_file, const std::filesystem::path& results,
                       const ScoreOptions& options);

// The label measures of one joined scan; region normals from planes.json or a fit.
PlaneScore score_planes(const JoinedScan& scan, const Normals& region_normals, const Normals& plane_normals,
                        const ScoreOptions& options);
Normals fit_region_normals(const LabelledGrid& grid);

}  // namespace score
