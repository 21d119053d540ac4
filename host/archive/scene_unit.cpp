// A scene's registration, views and report page: what `hybrid run` writes, byte for byte, from the scans'
// planes that their own units made.
#include <map>

#include "archive/kept_scan.hpp"
#include "archive/unit_run.hpp"
#include "batch/scene_run.hpp"
#include "core/log.hpp"
#include "core/shell_words.hpp"
#include "report/report.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;

// What a person would type; the folder is the reader's choice.
std::string command_of(const Unit& unit, const batch::RunRequest& request) {
  std::vector<std::string> words = {"hybrid", "run", unit.scene.string(), "--out", "DIR"};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  if (request.salvage) add({"--salvage"});
  if (request.leave_one_out) add({"--leave-one-out"});
  if (request.seed) add({"--seed", std::to_string(*request.seed)});
  for (const auto& assignment : request.assignments) add({"--set", assignment});
  return as_typed(words);
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
  if (unit.implied) request.scene = scene_of(unit);
  request.out = work;
  request.stages_by_scene = true;
  request.leave_one_out = unit.settings.leave_one_out.value_or(false);
  request.assignments = unit.settings.assignments;
  request.seed = unit.settings.seed;
  request.salvage = unit.settings.salvage.value_or(false);
  request.command = command_of(unit, request);
  request.kept_scan = [&](const std::string& id) -> std::optional<batch::ProcessedScan> {
    const auto found = planes.find(id);
    if (found == planes.end()) return std::nullopt;
    const Outcome& outcome = outcomes.of(found->second->index);
    if (outcome.state == UnitState::done) return read_or_nothing(store.object(outcome.key) / "kept.bin");
    // As the run itself would have found it; a scan that took its process down does not take this one too.
    throw Error(outcome.kind == ErrorKind::input ? ErrorKind::input : ErrorKind::failed, outcome.cause);
  };
  const auto run = batch::run_scene(
      queue, request, [&](const batch::SceneRun& made) { report::write_report(queue, made, work); });
  UnitResult result;
  for (const auto& failure : run.failures)
    result.failures.push_back({{"unit", failure.unit}, {"error", failure.error}});
  return result;
}

}  // namespace hybrid::archive
