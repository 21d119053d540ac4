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
#include "io/scene/implied_scene.hpp"

namespace hybrid::archive {
namespace {

constexpr std::uint64_t kDepthImageSamples = 640 * 480;

// So many scans in a folder are taken for those of one place without being told. Registering them costs up to
// half a second for each pair.
constexpr std::size_t kMostScansOfPlace = 24;

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
    if (request_.profile) profile_ = read_profile(*request_.profile);
    manifest_.archive = fs::absolute(request_.archive).lexically_normal();
    manifest_.build = request_.build;
    auto content = walk_archive(manifest_.archive);
    manifest_.problems = std::move(content.problems);
    manifest_.notes = std::move(content.notes);
    for (const auto& file : content.scenes) plan_scene(file);
    note_beside(content.beside_scenes);
    for (const auto& [folder, files] : by_folder(content.loose)) plan_folder(folder, files);
    note_equal_names();
    note_idle_overrides();
    for (Unit& scene : scenes_) manifest_.units.push_back(std::move(scene));
    plan_report();
    for (std::size_t i = 0; i < manifest_.units.size(); ++i)
      manifest_.units[i].index = manifest_.units[i].number = i;
    return std::move(manifest_);
  }

 private:
  io::ProfileSettings settings_of(const std::string& name) {
    names_.insert(name);
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

  Draft scene_unit(const std::string& name, const fs::path& scene) {
    Draft unit;
    unit.kind = UnitKind::scene;
    unit.id = "scene " + name;
    unit.result = name == "." ? "scene" : name + "/scene";
    unit.scene = scene;
    unit.settings = settings_of(name);
    unit.made_from = key_base(unit.kind, manifest_.build.all_sources);
    return unit;
  }

  void add_scene(Draft unit) {
    unit.made_from["leave_one_out"] = unit.settings.leave_one_out.value_or(false);
    unit.made_from["salvage"] = unit.settings.salvage.value_or(false);
    if (unit.settings.seed) unit.made_from["seed"] = *unit.settings.seed;
    for (const Input& input : unit.inputs) used_.insert(input.file.lexically_normal().string());
    scenes_.push_back(sealed(std::move(unit)));
  }

  void plan_scene(const fs::path& file) {
    const std::string name = scene_name(file);
    Draft unit = scene_unit(name, file);
    unit.inputs.push_back(cache_.look(file));
    unit.made_from["scene"] = print_of(unit.inputs.front());
    try {
      const auto scene = io::read_scene_file(file);
      scene_names_[scene.name].push_back(name);
      plan_stages(scene, name, unit);
    } catch (const std::exception& error) {
      manifest_.problems.push_back({named(file), in_batch_words(error.what())});
      unit.made_from["problem"] = error.what();
    }
    add_scene(std::move(unit));
  }

  // Loose scans that lie together. `place`: their folder, or the one file.
  void plan_implied(const fs::path& place, const std::vector<fs::path>& files) {
    const std::string name = named(place);
    Draft unit = scene_unit(name, place);
    unit.implied = true;
    unit.scans = files;
    const auto scene = io::implied_scene(place, files);
    unit.made_from["implied"] = scene.name;
    plan_stages(scene, name, unit);
    add_scene(std::move(unit));
  }

  void plan_stages(const io::SceneFile& scene, const std::string& name, Draft& unit) {
    const auto options =
        with_settings(batch::read_stage_options(scene, unit.settings.assignments), unit.settings);
    unit.made_from["options"] = batch::describe(options);
    if (!scene.has_export && batch::asks_for_export(scene, unit.settings.assignments))
      unit.made_from["export"] = true;  // with default options nothing else would tell
    plan_parts(scene, name, options, unit);
  }

  // The scans' units and the scene's other inputs.
  void plan_parts(const io::SceneFile& scene, const std::string& name, const batch::StageOptions& options,
                  Draft& unit) {
    const fs::path folder = scene.path.parent_path();
    SceneSize size;
    size.model = scene.model.has_value();
    batch::ScanNames names(scene);
    unit.made_from["scans"] = Json::array();
    for (std::size_t entry = 0; entry < scene.scans.size(); ++entry)
      plan_entry(scene, entry, name, options, names, unit, size);
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

  // Of one [[scan]]; adds its scans to the size. A file that cannot be listed has no units of its own: the
  // scene's run says why, as it does for a scan that the file does not have.
  void plan_entry(const io::SceneFile& scene, std::size_t entry, const std::string& name,
                  const batch::StageOptions& options, batch::ScanNames& names, Draft& unit, SceneSize& size) {
    const io::SceneScan& scan = scene.scans[entry];
    unit.inputs.push_back(cache_.look(scan.file));
    if (scan.depth) {  // small: the scene's run makes its planes
      unit.made_from["scans"].push_back(
          {{"file", fs::proximate(scan.file, scene.path.parent_path()).generic_string()},
           {"xxh3", print_of(unit.inputs.back())}});
      names.next(scan, 0, 1);
      ++size.scans;
      size.samples += kDepthImageSamples;
      return;
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
      manifest_.problems.push_back(
          {named(scene.implied ? scan.file : scene.path), in_batch_words(listing.problem)});
      unit.made_from["scans"].back()["problem"] = listing.problem;
      return;
    }
    size.scans += listing.scans.size();
    Json keys = Json::array();
    for (std::size_t i = 0; i < listing.scans.size(); ++i) {
      const std::string id = names.next(scan, static_cast<int>(i), static_cast<int>(listing.scans.size()));
      size.samples += listing.scans[i].samples;
      if (scene.edits.moves_depths_of(id))
        continue;  // the edit comes before the planes: the scene's run makes them
      Draft planes = planes_unit(scan.file, listing.scans[i], id, options, unit.settings);
      // Loose scans keep theirs whether they make a scene or not.
      planes.id = fmt::format("planes {} {}", scene.implied ? named(scan.file) : name, id);
      planes.scene = unit.scene;
      planes.implied = scene.implied;
      planes.entry = scene.implied ? 0 : entry;
      if (scan.scanner)
        planes.made_from["scanner"] = {scan.scanner->x(), scan.scanner->y(), scan.scanner->z()};
      if (scan.axes != io::ScanAxes::z_up)
        planes.made_from["axes"] = io::kScanAxesNames[static_cast<std::size_t>(scan.axes)];
      if (scan.unit_m != 1) planes.made_from["unit_m"] = scan.unit_m;
      if (!scene.implied)  // the scene file says how to read the scan
        planes.inputs.push_back(unit.inputs.front());
      unit.needs.push_back(manifest_.units.size());
      manifest_.units.push_back(sealed(std::move(planes)));
      keys.push_back(manifest_.units.back().key);
    }
    unit.made_from["scans"].back()["planes"] = keys;
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

  static std::map<fs::path, std::vector<fs::path>> by_folder(const std::vector<fs::path>& files) {
    std::map<fs::path, std::vector<fs::path>> folders;
    for (const auto& file : files) folders[file.parent_path()].push_back(file);
    return folders;
  }

  // The loose scans of a folder: a scene, scenes of a file each, or units without one.
  void plan_folder(const fs::path& folder, const std::vector<fs::path>& files) {
    const std::string name = named(folder);
    const io::Group group = settings_of(name).group.value_or(io::Group::automatic);
    std::vector<LooseFile> found;
    std::size_t scans = 0;
    for (const auto& file : files) {
      if (auto listed = list_loose(file, files)) {
        scans += listed->listing.scans.size();
        found.push_back(std::move(*listed));
      }
    }
    if (group == io::Group::automatic && scans > kMostScansOfPlace && found.size() > 1)
      manifest_.notes.push_back(
          {name,
           fmt::format("{} loose scans: more than {} are not taken for one place; group = \"folder\" in "
                       "[run] of a profile registers them to each other",
                       scans, kMostScansOfPlace)});
    const bool together =
        group == io::Group::folder || (group == io::Group::automatic && scans <= kMostScansOfPlace);
    if (together && found.size() > 1) {
      std::vector<fs::path> of_scene;
      for (const LooseFile& one : found) of_scene.push_back(one.file);
      return plan_implied(folder, of_scene);
    }
    for (const LooseFile& one : found)
      if (group != io::Group::none && one.listing.scans.size() > 1)
        plan_implied(one.file, {one.file});
      else
        plan_loose(one);
  }

  struct LooseFile {
    fs::path file;
    ScanListing listing;  // of one that cannot be read a scan that will tell
  };

  // Nothing for a file that is no scan of its own.
  std::optional<LooseFile> list_loose(const fs::path& file, const std::vector<fs::path>& beside) {
    if (used_.count(file.string()) > 0) return std::nullopt;
    const std::string name = named(file), extension = file.extension().string();
    if (io::belongs_to_range_image(file, beside)) return std::nullopt;
    LooseFile one{file, cache_.list(file, profile_.settings_of(name).salvage.value_or(false))};
    if (one.listing.problem.empty()) return one;
    if (extension == ".exr" || extension == ".laz") {
      manifest_.notes.push_back({name, "no scan that can be read: " + one.listing.problem});
      return std::nullopt;
    }
    if (io::holds_photographs_alone(file)) {
      manifest_.notes.push_back({name, "photographs and no scan: left out"});
      return std::nullopt;
    }
    one.listing.scans = {{0, 0}};
    return one;
  }

  void plan_loose(const LooseFile& one) {
    const std::string name = named(one.file);
    const auto settings = settings_of(name);
    if (!one.listing.problem.empty())
      manifest_.problems.push_back({name, in_batch_words(one.listing.problem)});
    const auto& scans = one.listing.scans;
    const auto options = options_of_loose(settings);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const std::string id =
          io::default_scan_id(one.file, static_cast<int>(i), static_cast<int>(scans.size()), {});
      Draft unit = planes_unit(one.file, scans[i], id, options, settings);
      unit.id = fmt::format("planes {} {}", name, id);
      unit.result = fmt::format("{}/planes-{}", name, id);
      unit.made_from["loose"] = one.file.filename().string();
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
    const std::vector<std::string> some(
        names_.begin(), std::next(names_.begin(), std::min<std::ptrdiff_t>(3, std::ssize(names_))));
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
    const auto estimate = estimate_report(manifest_.units.size());
    unit.estimate_s = estimate.cpu_s;
    unit.estimate_bytes = estimate.bytes;
    manifest_.units.push_back(std::move(unit));
  }

  const PlanRequest& request_;
  InputCache& cache_;
  io::ProfileFile profile_;
  Manifest manifest_;
  std::vector<Unit> scenes_;
  std::set<std::string> names_;                                  // of scenes and loose scans
  std::set<std::string> used_;                                   // files that a scene reads
  std::map<std::string, std::vector<std::string>> scene_names_;  // [scene] name -> scenes
};

void check_options(const fs::path& file, const io::ProfileSettings& settings) {
  batch::StageOptions options;
  for (std::size_t i = 0; i < settings.assignments.size(); ++i) {
    const std::string& assignment = settings.assignments[i];
    with_context(fmt::format("{}:{}: [{}]", file.string(), settings.lines[i],
                             assignment.substr(0, assignment.find('.'))),
                 [&] { options.apply(assignment); });
  }
}

}  // namespace

io::ProfileFile read_profile(const fs::path& file) {
  io::ProfileFile profile = io::read_profile_file(file);
  check_options(file, profile.all);
  for (const auto& one : profile.overrides) check_options(file, one.settings);
  return profile;
}

Manifest make_plan(const PlanRequest& request, InputCache& cache) {
  return Planner(request, cache).go();
}

}  // namespace hybrid::archive
