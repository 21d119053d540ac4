#include "archive/plan.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "archive/estimate.hpp"
#include "archive/outcome.hpp"
#include "archive/scene_inputs.hpp"
#include "archive/store.hpp"
#include "batch/scene_scan.hpp"
#include "batch/stage_options.hpp"
#include "core/error.hpp"

namespace hybrid::archive {
namespace {

constexpr std::uint64_t kDepthImageSamples = 640 * 480;

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Whatever the content of units' folders or the making of keys becomes.
constexpr int kKeyFormat = 1;

Json print_of(const Input& input) {
  return input.xxh3.empty() ? Json{{"problem", input.problem}} : Json(input.xxh3);
}

batch::StageOptions with_settings(batch::StageOptions options, const io::ProfileSettings& settings) {
  if (settings.seed) options.set_seed(*settings.seed);
  return options;
}

batch::StageOptions options_of_loose(const io::ProfileSettings& settings) {
  batch::StageOptions options;
  for (const auto& assignment : settings.assignments) options.set(assignment);
  return with_settings(options, settings);
}

// A unit while its key is made.
struct Draft : Unit {
  Json made_from;
};

Unit sealed(Draft&& draft) {
  draft.from = draft.made_from.dump();
  draft.key = hash_of(draft.from);
  return std::move(draft);
}

class Planner {
 public:
  Planner(const PlanRequest& request, InputCache& cache) : request_(request), cache_(cache) {}

  Manifest go() {
    if (request_.profile) read_profile();
    manifest_.archive = fs::absolute(request_.archive).lexically_normal();
    manifest_.build = request_.build;
    auto content = walk_archive(manifest_.archive);
    manifest_.problems = std::move(content.problems);
    manifest_.notes = std::move(content.notes);
    for (const auto& file : content.scenes) plan_scene(file);
    note_beside(content.beside_scenes);
    for (const auto& file : content.loose) plan_loose(file, content.loose);
    note_equal_names();
    note_idle_overrides();
    for (Unit& scene : scenes_) manifest_.units.push_back(std::move(scene));
    plan_report();
    for (std::size_t i = 0; i < manifest_.units.size(); ++i)
      manifest_.units[i].index = manifest_.units[i].number = i;
    return std::move(manifest_);
  }

 private:
  void read_profile() {
    profile_ = io::read_profile_file(*request_.profile);
    check_options(profile_.all);
    for (const auto& one : profile_.overrides) check_options(one.settings);
  }

  void check_options(const io::ProfileSettings& settings) const {
    batch::StageOptions options;
    for (std::size_t i = 0; i < settings.assignments.size(); ++i) {
      const std::string& assignment = settings.assignments[i];
      with_context(fmt::format("{}:{}: [{}]", request_.profile->string(), settings.lines[i],
                               assignment.substr(0, assignment.find('.'))),
                   [&] { options.apply(assignment); });
    }
  }

  io::ProfileSettings settings_of(const std::string& name) {
    names_.push_back(name);
    return profile_.settings_of(name);
  }

  std::string named(const fs::path& path) const {
    return path.lexically_relative(manifest_.archive).generic_string();
  }

  // A scene is called by its folder, one of several in a folder by its file, too.
  std::string scene_name(const fs::path& file) const {
    const std::string folder = named(file.parent_path());
    if (file.filename() == "scene.toml") return folder;
    const std::string stem = file.stem().string();  // "a.scene"
    return folder == "." ? stem : folder + "/" + stem;
  }

  Json key_base(UnitKind kind, const std::string& sources) const {
    return {{"kind", name_of(kind)},
            {"format", kKeyFormat},
            {"sources", sources},
            {"build", manifest_.build.kind},
            {"device", manifest_.build.device}};
  }

  // Scan `index` of a file, alone or as entry of a scene.
  Draft planes_unit(const fs::path& file, const ScanListing::One& listed, const std::string& id,
                    const batch::StageOptions& options, const io::ProfileSettings& settings) {
    Draft unit;
    unit.kind = UnitKind::planes;
    unit.file = file;
    unit.scan_index = listed.index;
    unit.scan_id = id;
    unit.settings = settings;
    unit.inputs.push_back(cache_.look(file));
    unit.made_from = key_base(unit.kind, manifest_.build.planes_sources);
    unit.made_from["scan"] = {{"id", id}, {"index", listed.index}, {"xxh3", print_of(unit.inputs.front())}};
    for (const auto& companion : scan_companions(file)) {
      unit.inputs.push_back(cache_.look(companion));
      unit.made_from["companions"].push_back(
          {{"file", companion.lexically_relative(file.parent_path()).generic_string()},
           {"xxh3", print_of(unit.inputs.back())}});
    }
    unit.made_from["salvage"] = settings.salvage.value_or(false);
    unit.made_from["options"] = batch::describe(options)["planes"];
    if (settings.seed) unit.made_from["seed"] = *settings.seed;
    const auto estimate = estimate_planes(listed.samples ? listed.samples : unit.inputs.front().bytes / 16);
    unit.estimate_s = estimate.cpu_s;
    unit.estimate_bytes = estimate.bytes;
    return unit;
  }

  void plan_scene(const fs::path& file) {
    Draft unit;
    unit.kind = UnitKind::scene;
    const std::string name = scene_name(file);
    unit.id = "scene " + name;
    unit.result = name == "." ? "scene" : name + "/scene";
    unit.scene = file;
    unit.settings = settings_of(name);
    unit.inputs.push_back(cache_.look(file));
    unit.made_from = key_base(unit.kind, manifest_.build.all_sources);
    unit.made_from["scene"] = print_of(unit.inputs.front());
    try {
      const auto scene = io::read_scene_file(file);
      const auto options =
          with_settings(batch::read_stage_options(scene, unit.settings.assignments), unit.settings);
      scene_names_[scene.name].push_back(name);
      unit.made_from["options"] = batch::describe(options);
      if (!scene.has_export && batch::asks_for_export(scene, unit.settings.assignments))
        unit.made_from["export"] = true;  // with default options nothing else would tell
      plan_parts(scene, name, options, unit);
    } catch (const std::exception& error) {
      manifest_.problems.push_back({named(file), in_batch_words(error.what())});
      unit.made_from["problem"] = error.what();
    }
    unit.made_from["leave_one_out"] = unit.settings.leave_one_out.value_or(false);
    unit.made_from["salvage"] = unit.settings.salvage.value_or(false);
    if (unit.settings.seed) unit.made_from["seed"] = *unit.settings.seed;
    for (const Input& input : unit.inputs) used_.insert(input.file.lexically_normal().string());
    scenes_.push_back(sealed(std::move(unit)));
  }

  // The scans' units and the scene's other inputs.
  void plan_parts(const io::SceneFile& scene, const std::string& name, const batch::StageOptions& options,
                  Draft& unit) {
    const fs::path folder = scene.path.parent_path();
    SceneSize size;
    batch::ScanNames names(scene);
    unit.made_from["scans"] = Json::array();
    for (std::size_t entry = 0; entry < scene.scans.size(); ++entry)
      size.samples += plan_entry(scene, entry, name, options, names, unit);
    auto files = scene_inputs(scene);
    for (fs::path& file : files) file = file.lexically_normal();
    std::sort(files.begin(), files.end());
    files.erase(std::unique(files.begin(), files.end()), files.end());
    unit.made_from["inputs"] = Json::array();
    for (Input& input : cache_.look(files)) {
      unit.made_from["inputs"].push_back(
          {{"file", fs::proximate(input.file, folder).generic_string()}, {"xxh3", print_of(input)}});
      size.photograph_bytes += input.bytes;
      ++size.photographs;
      unit.inputs.push_back(std::move(input));
    }
    for (const auto& view : scene.views)
      if (view.photograph.empty())
        size.view_pixels +=
            static_cast<std::uint64_t>(view.size[0]) * static_cast<std::uint64_t>(view.size[1]);
      else
        ++size.photograph_views;
    if (unit.settings.leave_one_out.value_or(false)) size.photograph_views += size.photographs;
    const auto estimate = estimate_scene(size);
    unit.estimate_s = estimate.cpu_s;
    unit.estimate_bytes = estimate.bytes;
  }

  // Of one [[scan]]; returns its samples. A file that cannot be listed has no units of its own: the scene's
  // run says why, as it does for a scan that the file does not have.
  std::uint64_t plan_entry(const io::SceneFile& scene, std::size_t entry, const std::string& name,
                           const batch::StageOptions& options, batch::ScanNames& names, Draft& unit) {
    const io::SceneScan& scan = scene.scans[entry];
    unit.inputs.push_back(cache_.look(scan.file));
    if (scan.depth) {  // small: the scene's run makes its planes
      unit.made_from["scans"].push_back(
          {{"file", fs::proximate(scan.file, scene.path.parent_path()).generic_string()},
           {"xxh3", print_of(unit.inputs.back())}});
      names.next(scan, 0, 1);
      return kDepthImageSamples;
    }
    auto listing = cache_.list(scan.file, unit.settings.salvage.value_or(false));
    if (scan.index && listing.problem.empty()) {
      const auto index = static_cast<std::size_t>(*scan.index);
      if (index < listing.scans.size())
        listing.scans = {listing.scans[index]};
      else
        listing.problem = fmt::format("{}: index {}: the file holds {} scans (0-based)", scan.file.string(),
                                      index, listing.scans.size());
    }
    unit.made_from["scans"].push_back(
        {{"file", fs::proximate(scan.file, scene.path.parent_path()).generic_string()},
         {"xxh3", print_of(unit.inputs.back())}});
    if (!listing.problem.empty()) {
      manifest_.problems.push_back({named(scene.path), in_batch_words(listing.problem)});
      unit.made_from["scans"].back()["problem"] = listing.problem;
      return 0;
    }
    std::uint64_t samples = 0;
    Json keys = Json::array();
    for (std::size_t i = 0; i < listing.scans.size(); ++i) {
      const std::string id = names.next(scan, static_cast<int>(i), static_cast<int>(listing.scans.size()));
      samples += listing.scans[i].samples;
      if (scene.edits.moves_depths_of(id))
        continue;  // the edit comes before the planes: the scene's run makes them
      Draft planes = planes_unit(scan.file, listing.scans[i], id, options, unit.settings);
      planes.id = fmt::format("planes {} {}", name, id);
      planes.scene = scene.path;
      planes.entry = entry;
      if (scan.scanner)
        planes.made_from["scanner"] = {scan.scanner->x(), scan.scanner->y(), scan.scanner->z()};
      planes.inputs.push_back(unit.inputs.front());  // the scene file says how to read the scan
      unit.needs.push_back(manifest_.units.size());
      manifest_.units.push_back(sealed(std::move(planes)));
      keys.push_back(manifest_.units.back().key);
    }
    unit.made_from["scans"].back()["planes"] = keys;
    return samples;
  }

  void note_beside(const std::vector<fs::path>& files) {
    std::map<std::string, int> counts;
    for (const auto& file : files) {
      if (used_.count(file.string()) == 0) ++counts[named(file.parent_path())];
    }
    for (const auto& [folder, count] : counts)
      manifest_.notes.push_back(
          {folder, fmt::format("{} files with a scan's extension that no scene names: left out", count)});
  }

  void plan_loose(const fs::path& file, const std::vector<fs::path>& all) {
    if (used_.count(file.string()) > 0) return;
    const std::string name = named(file), extension = file.extension().string();
    if (file.filename() == "extra.ply" && std::any_of(all.begin(), all.end(), [&](const fs::path& other) {
          return other.parent_path() == file.parent_path() && other.extension() == ".exr";
        }))
      return;  // of the range image beside it
    const auto settings = settings_of(name);
    const auto listing = cache_.list(file, settings.salvage.value_or(false));
    if (!listing.problem.empty() && (extension == ".exr" || extension == ".laz")) {
      manifest_.notes.push_back({name, "no scan that can be read: " + listing.problem});
      return;
    }
    auto scans = listing.scans;
    if (!listing.problem.empty()) {  // its unit will tell
      manifest_.problems.push_back({name, in_batch_words(listing.problem)});
      scans = {{0, 0}};
    }
    const auto options = options_of_loose(settings);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const std::string id =
          io::default_scan_id(file, static_cast<int>(i), static_cast<int>(scans.size()), {});
      Draft unit = planes_unit(file, scans[i], id, options, settings);
      unit.id = fmt::format("planes {} {}", name, id);
      unit.result = fmt::format("{}/planes-{}", name, id);
      unit.made_from["loose"] = file.filename().string();
      manifest_.units.push_back(sealed(std::move(unit)));
    }
  }

  void note_equal_names() {
    for (const auto& [name, where] : scene_names_)
      for (std::size_t i = 1; i < where.size(); ++i)
        manifest_.notes.push_back(
            {where[i], fmt::format("its [scene] name \"{}\" is that of {}, too; here they are told apart by "
                                   "their folders",
                                   name, where.front())});
  }

  void note_idle_overrides() {
    const std::vector<std::string> some(names_.begin(),
                                        names_.begin() + std::min<std::ptrdiff_t>(3, std::ssize(names_)));
    for (const auto& one : profile_.overrides)
      if (std::none_of(names_.begin(), names_.end(), [&](const auto& name) { return one.matches(name); }))
        manifest_.notes.push_back(
            {fmt::format("{}:{}", request_.profile->string(), one.line),
             fmt::format(
                 "[[scene]] match = \"{}\": expected the name of a scene or loose scan, * and ? as in "
                 "a shell, found none that matches among {} ({}{})",
                 one.match, names_.size(), fmt::join(some, ", "), names_.size() > 3 ? ", ..." : "")});
  }

  void plan_report() {
    if (manifest_.units.empty()) return;
    Draft unit;
    unit.kind = UnitKind::report;
    unit.id = unit.result = "report";
    unit.made_from = key_base(unit.kind, manifest_.build.all_sources);
    unit.made_from["units"] = Json::array();
    for (std::size_t i = 0; i < manifest_.units.size(); ++i) {
      unit.needs.push_back(i);
      unit.made_from["units"].push_back({manifest_.units[i].id, manifest_.units[i].key});
    }
    unit.made_from["problems"] = Json::array();
    for (const auto& [path, what] : manifest_.problems) unit.made_from["problems"].push_back({path, what});
    unit.key = hash_of(unit.made_from.dump());
    unit.made_from.erase("units");  // they stand in the manifest already
    unit.from = unit.made_from.dump();
    unit.estimate_s = 0.05;
    unit.estimate_bytes = 200'000'000;
    manifest_.units.push_back(std::move(unit));
  }

  const PlanRequest& request_;
  InputCache& cache_;
  io::ProfileFile profile_;
  Manifest manifest_;
  std::vector<Unit> scenes_;
  std::vector<std::string> names_;                               // of scenes and loose scans
  std::set<std::string> used_;                                   // files that a scene reads
  std::map<std::string, std::vector<std::string>> scene_names_;  // [scene] name -> scenes
};

}  // namespace

Manifest make_plan(const PlanRequest& request, InputCache& cache) {
  return Planner(request, cache).go();
}

}  // namespace hybrid::archive
