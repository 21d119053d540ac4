#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "batch/drawn_samples.hpp"
#include "batch/registration/registration_unit.hpp"
#include "batch/render_unit.hpp"
#include "batch/scene_scan.hpp"
#include "device/queue.hpp"

namespace hybrid::batch {

// Stages of the contract that this version has and that a run without --only has; "export" beside them.
inline const std::set<std::string> kAllStages = {"planes", "register", "edit", "render", "report"};

struct RunRequest {
  std::filesystem::path scene_file;    // or a folder or file of scans: io::read_scene_file()
  std::optional<io::SceneFile> scene;  // what it holds, where that is known
  std::filesystem::path out;
  // Whose outputs are written. What they need is computed again from the inputs, never taken from `out`;
  // "report" brings the others with it, since its page shows their files.
  std::set<std::string> stages = kAllStages;
  // `stages` are those that a run has without --only: with "export" where asks_for_export()
  // (stage_options.hpp), without "edit" and "render" where the scene has no model and nothing to draw.
  bool stages_by_scene = false;
  std::string only_view;                 // render: this view alone
  bool scene_views = true;               // render: the scene file's views
  bool leave_one_out = false;            // render: then every photograph from the others
  std::optional<std::string> show;       // of every view, over the scene file: "proxy" | "scan" | "both"
  std::vector<std::string> assignments;  // SECTION.KEY=VALUE, override the scene file
  std::optional<OptionValue> square;     // overrides the scene file
  int tile = 1024;
  std::optional<int> seed;  // overrides the scene file
  bool force = false;       // write into the output folder of another scene
  bool salvage = false;     // of damaged scans what is good (io::ReadOptions)
  bool quiet = false;
  // A scan by its id, where it was processed before with the same options: nothing to read and process it
  // here. What it throws is that scan's failure.
  std::function<std::optional<ProcessedScan>(const std::string& id)> kept_scan;
  std::string command;  // what failures say runs them again
};

// A unit that failed while the others went on.
struct UnitFailure {
  std::string unit;
  std::string error;
  ErrorKind kind;
  std::string command;  // runs it again
};

// All products of a run, in memory, for the report.
struct SceneRun {
  io::SceneFile scene;
  std::optional<PolygonModel> model;
  PhotographSet photographs;
  std::vector<ScanProduct> products;
  std::vector<std::optional<ScanRegistration>>
      registrations;  // one per product; nothing when it failed, abstained or was not asked
  std::vector<std::optional<ScanRegistration>> abstentions;  // one per product; of those that abstained
  WorldContours contours;                                    // of the registered scans
  std::vector<UnitFailure> failures;
  nlohmann::ordered_json summary;
  nlohmann::ordered_json timing;
};

// Writes the report of a run whose summary is made (report/ lies above this folder).
using WriteReport = std::function<void(const SceneRun&)>;

// Runs a scene's stages and writes DIR's files, summary.json last. Inputs that concern the whole scene (scene
// file, model, cameras) throw; a scan, view or report that fails is recorded in `failures` and the others go
// on. A lost device, a full disk and an interrupt end the run.
SceneRun run_scene(device::Queue& queue, const RunRequest& request, const WriteReport& write_report);

// 0, or 3 when some units failed, or the failures' own code when nothing succeeded.
int exit_code(const SceneRun& run);

}  // namespace hybrid::batch
