// A scene's registration, views and report page: what `hybrid run` writes, byte for byte, from the scans'
// planes that their own units made.
#include <map>

#include "archive/kept_scan.hpp"
#include "archive/unit_run.hpp"
#include "batch/scene_run.hpp"
#include "core/log.hpp"
#include "report/report.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;

// What a person would type; the folder is the reader's choice.
std::string command_of(const Unit& unit) {
  std::string command = fmt::format("hybrid run {} --out DIR", unit.scene.string());
  if (unit.settings.salvage.value_or(false)) command += " --salvage";
  if (unit.settings.leave_one_out.value_or(false)) command += " --leave-one-out";
  if (unit.settings.seed) command += fmt::format(" --seed {}", *unit.settings.seed);
  for (const auto& assignment : unit.settings.assignments) command += " --set " + assignment;
  return command;
}

// Stages that need a model are for scenes that have one; a scene that cannot be read will say so itself.
std::set<std::string> stages_of(const fs::path& scene) {
  auto stages = batch::kAllStages;
  try {
    if (!io::read_scene_file(scene).model)
      for (const char* stage : {"register", "edit", "render"}) stages.erase(stage);
  } catch (const Error&) {
  }
  return stages;
}

// A file that the disk has damaged costs time, not the scene.
std::optional<batch::ProcessedScan> read_or_nothing(const fs::path& file) {
  try {
    return read_kept_scan(file);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    log::warning("{}; the scan is processed again", error.what());
    return std::nullopt;
  }
}

}  // namespace

UnitResult run_scene_unit(device::Queue& queue, const Store& store, const Manifest& manifest,
                          const Unit& unit, Outcomes& outcomes, const fs::path& work) {
  std::map<std::string, const Unit*> planes;
  for (const std::size_t need : unit.needs) planes[manifest.units[need].scan_id] = &manifest.units[need];
  batch::RunRequest request;
  request.scene_file = unit.scene;
  request.out = work;
  request.stages = stages_of(unit.scene);
  request.export_if_asked = true;
  request.leave_one_out = unit.settings.leave_one_out.value_or(false);
  request.assignments = unit.settings.assignments;
  request.seed = unit.settings.seed;
  request.salvage = unit.settings.salvage.value_or(false);
  request.command = command_of(unit);
  request.kept_scan = [&](const std::string& id) -> std::optional<batch::ProcessedScan> {
    const auto found = planes.find(id);
    if (found == planes.end()) return std::nullopt;
    const Outcome& outcome = outcomes.of(found->second->index);
    if (outcome.state == UnitState::done) return read_or_nothing(store.object(outcome.key) / "kept.bin");
    // As the run itself would have found it; a scan that took its process down does not take this one too.
    throw Error(outcome.kind == ErrorKind::input ? ErrorKind::input : ErrorKind::failed, outcome.error);
  };
  const auto run = batch::run_scene(
      queue, request, [&](const batch::SceneRun& made) { report::write_report(queue, made, work); });
  UnitResult result;
  for (const auto& failure : run.failures)
    result.failures.push_back({{"unit", failure.unit}, {"error", failure.error}});
  return result;
}

}  // namespace hybrid::archive
