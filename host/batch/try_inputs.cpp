#include "batch/try_inputs.hpp"

#include <fmt/ranges.h>

#include "batch/editing/scene_editing.hpp"
#include "batch/output_folder.hpp"
#include "batch/photographs/photograph_files.hpp"
#include "batch/photographs/photograph_set.hpp"
#include "batch/scene_model.hpp"
#include "batch/scene_request.hpp"
#include "core/error.hpp"
#include "io/cameras/read_cameras.hpp"
#include "io/depth_image.hpp"
#include "io/e57/e57_photographs.hpp"
#include "io/picture.hpp"
#include "io/read_scan.hpp"
#include "io/truth.hpp"

namespace hybrid::batch {
namespace {

namespace fs = std::filesystem;

class Trial {
 public:
  // What the body throws of an input becomes a problem.
  template <typename Body>
  bool part(const std::string& name, const Body& body) {
    try {
      with_context(name, body);
      return true;
    } catch (const Error& error) {
      if (ends_the_run(error.kind())) throw;
      run_.problems.emplace_back(error.what());
      return false;
    }
  }

  void line(std::string text) { run_.lines.push_back(std::move(text)); }

  void scan(const std::string& id, const fs::path& file, const io::ScanEntry& entry) {
    good_scans_ += part("scan " + id, [&] {
      if (!entry.problem.empty()) fail_input("{}", entry.problem);
      std::string size = entry.samples > 0 ? fmt::format(", {} points", entry.samples) : "";
      if (entry.grid_rows > 0) size += fmt::format(", grid {} x {}", entry.grid_rows, entry.grid_cols);
      line(fmt::format("  scan {}: {}{}", id, file.string(), size));
    });
  }

  // With `fatal` a problem ends the run, whatever else is good.
  DryRun end(bool fatal) {
    if (!run_.problems.empty())
      run_.exit_code = fatal || good_scans_ == 0 ? hybrid::exit_code(ErrorKind::input) : 3;
    return std::move(run_);
  }

 private:
  DryRun run_;
  int good_scans_ = 0;
};

void try_scans(const io::SceneFile& scene, bool salvage, Trial& trial) {
  ScanNames names(scene);
  for (const io::SceneScan& entry : scene.scans)
    trial.part("scan " + given_name(entry), [&] {
      const auto listed = list_scans_of(scene, entry, salvage);
      if (entry.depth) io::read_depth_image(entry.file, *entry.depth);
      const auto count = static_cast<int>(listed.size());
      for (int i = 0; i < count; ++i)
        trial.scan(names.next(entry, i, count), entry.file, listed[static_cast<std::size_t>(i)]);
    });
}

PolygonModel try_model(const io::SceneFile& scene, Trial& trial) {
  std::vector<io::ObjFaceNames> names;
  const PolygonModel model = read_scene_model(*scene.model, names);
  const PolygonModel edited = SceneEditing().edit(scene, model, names);
  check_outlines(*scene.model, model, names, edited);
  trial.line(fmt::format("  model {}: {} faces", scene.model->file.string(), model.faces.size()) +
             (edited.faces.size() != model.faces.size() ? fmt::format(", {} after edits", edited.faces.size())
                                                        : ""));
  return edited;
}

// Whether all of them can be used.
bool try_photographs(const io::SceneFile::Photographs& section, const PolygonModel& model,
                     const StageOptions& options, bool salvage, Trial& trial) {
  bool good = true;
  for (const fs::path& file : section.e57_files)
    good &= trial.part("photographs", [&] {
      const io::E57File opened(file, {.salvage = salvage});
      for (const auto& one : io::e57_photographs(opened.contents()).photographs)
        trial.line(fmt::format("  photograph {}: {}", one.photograph.name, io::place_of(opened, one.image)));
    });
  if (!section.e57_files.empty()) return good;
  PhotographSet set;
  set.cameras = io::read_cameras(section.cameras, section.images).photographs;
  const auto files = photograph_files(section, set.cameras, salvage).all;
  std::size_t left_out = 0;
  const auto try_one = [&](std::size_t i) {
    const Camera& camera = set.cameras[i].camera;
    io::check_photograph(files[i], camera.width, camera.height);
    trial.line(fmt::format("  photograph {}: {} x {}", files[i].string(), camera.width, camera.height));
  };
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!salvage) {
      good &= trial.part("photographs", [&] { try_one(i); });
      continue;
    }
    try {
      try_one(i);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      trial.line(fmt::format("  photograph {} is left out: {}", set.cameras[i].name, error.what()));
      ++left_out;
    }
  }
  if (left_out > 0 && left_out == files.size())
    good &= trial.part("photographs", [&] { fail_input("none of the {} can be read", left_out); });
  good &= trial.part("photographs", [&] {
    place_by_landmarks(section, model, options.landmarks.snap_tolerance_m, set);
    for (const std::string& warning : set.warnings) trial.line("  warning: " + warning);
    if (set.landmarks)
      trial.line(fmt::format("  {} landmarks of photographs: rms {:.1f} mm", section.landmarks.size(),
                             1000 * set.landmarks->rms_m));
  });
  return good;
}

}  // namespace

DryRun try_scene(const RunRequest& request) {
  auto stages = request.stages;
  StageOptions options;
  const auto scene = read_scene(request, stages, options);
  check_edited_scans_early(scene, request.salvage);
  Trial trial;
  trial.line(fmt::format("scene {}: {} scan entries, {} views, stages {}, into {}", scene.name,
                         scene.scans.size(), scene.views.size(), fmt::join(stages, ", "),
                         request.out.string()));
  const PolygonModel model = scene.model ? try_model(scene, trial) : PolygonModel();
  if (scene.truth) io::read_truth(*scene.truth);
  const bool drawn = stages.count("render") + stages.count("export") > 0 || request.leave_one_out;
  const bool photographs = !drawn || !scene.photographs ||
                           try_photographs(*scene.photographs, model, options, request.salvage, trial);
  try_scans(scene, request.salvage, trial);
  return trial.end(!photographs);
}

DryRun try_planes(const PlanesRequest& request) {
  check_output_folder(request.out, "", {}, request.force);
  Trial trial;
  trial.line(fmt::format("planes of {} files, into {}", request.files.size(), request.out.string()));
  std::vector<std::string> ids;
  for (const fs::path& file : request.files)
    trial.part("scan " + file.string(), [&] {
      const auto entries = io::list_scans(file, {.salvage = request.salvage});
      for (std::size_t i = 0; i < entries.size(); ++i) {
        ids.push_back(io::default_scan_id(file, static_cast<int>(i), static_cast<int>(entries.size()), ids));
        trial.scan(ids.back(), file, entries[i]);
      }
    });
  return trial.end(false);
}

}  // namespace hybrid::batch
