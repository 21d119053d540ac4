// A scan's planes: of a scene's scan what the scene goes on from, of a loose one what `hybrid planes` writes.
#include "archive/kept_scan.hpp"
#include "archive/unit_run.hpp"
#include "batch/planes_json.hpp"
#include "batch/planes_run.hpp"
#include "batch/scene_scan.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;

void run_loose(device::Queue& queue, const Unit& unit, const fs::path& work) {
  batch::PlanesRequest request;
  request.files = {unit.file};
  request.out = work;
  request.only = unit.scan_index;
  request.salvage = unit.settings.salvage.value_or(false);
  for (const auto& assignment : unit.settings.assignments) request.options.set(assignment);
  if (unit.settings.seed) request.options.set_seed(*unit.settings.seed);
  const auto run = batch::run_planes(queue, request);
  if (run.exit_code == 0) return;
  const ErrorKind kind = run.exit_code == exit_code(ErrorKind::input) ? ErrorKind::input : ErrorKind::failed;
  throw Error(kind, run.summary["failures"].back()["error"].get<std::string>());
}

void run_scan_of_scene(device::Queue& queue, const Unit& unit, const fs::path& work) {
  const auto scene = scene_of(unit);
  auto options = batch::read_stage_options(scene, unit.settings.assignments);
  if (unit.settings.seed) options.set_seed(*unit.settings.seed);
  io::SceneScan entry = scene.scans.at(unit.entry);
  entry.index = static_cast<int>(unit.scan_index);
  const auto scans = batch::list_scene_scans(entry, unit.settings.salvage.value_or(false));
  batch::Progress progress(false);
  progress.expect(7);
  progress.step("read", "scan " + unit.scan_id);
  auto kept = batch::make_planes(queue, unit.scan_id, entry, scans.front(), options, progress);
  progress.step("write", "scan " + unit.scan_id);
  write_kept_scan(work / "kept.bin", kept);
  io::write_text(work / "summary.json", json_text(batch::scan_figures(kept.product)) + "\n");
}

}  // namespace

UnitResult run_planes_unit(device::Queue& queue, const Unit& unit, const fs::path& work) {
  if (unit.scene.empty())
    run_loose(queue, unit, work);
  else
    run_scan_of_scene(queue, unit, work);
  return {};
}

}  // namespace hybrid::archive
