#include "batch/stage_options.hpp"

#include <algorithm>
#include <charconv>

#include "batch/registration/registered_scans.hpp"
#include "core/suggest.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

// Landmark options and what the pipeline itself decides: the rows of [register] that are not ICP's.
const std::vector<OptionRow<StageOptions>>& register_rows() {
  static const std::vector<OptionRow<StageOptions>> rows = {
      {"explain_m",
       "m",
       &StageOptions::explain_m,
       0.001,
       10,
       "a planar sample this near a face is explained by it",
       {}},
      {"write",
       "",
       &StageOptions::write_registered,
       0,
       0,
       "registered scans are written as some of e57 las pcd ply pts ptx, separated by blanks or commas",
       {}},
      {"joint", "", &StageOptions::joint, 0, 0, "refine the poses of all scans together", {}},
      {"automatic",
       "",
       &StageOptions::automatic,
       0,
       0,
       "align scans without a start: those that have none, first of all, or never",
       {"missing", "first", "never"}},
  };
  return rows;
}

const std::vector<OptionRow<StageOptions>>& planes_rows() {
  static const std::vector<OptionRow<StageOptions>> rows = {
      {"lossless", "", &StageOptions::lossless, 0, 0,
       "also write scans/<id>/samples.hsf: every sample exactly, the discarded ones by their planes"},
  };
  return rows;
}

const std::vector<OptionRow<stages::LandmarkOptions>>& landmark_rows() {
  static const std::vector<OptionRow<stages::LandmarkOptions>> rows = {
      {"snap_tolerance_m", "m", &stages::LandmarkOptions::snap_tolerance_m, 0, 1000,
       "a pick farther from every model vertex is an error"},
  };
  return rows;
}

// Sets `key` in the first of `tables` that has it.
template <typename T>
bool apply(const std::string& key, const OptionValue& value, T& options,
           const std::vector<OptionRow<T>>& table) {
  const auto* row = find_option(table, key);
  if (row) set_option(options, *row, value);
  return row != nullptr;
}

// Each sets one key of its section; false when the section has no such key.
bool apply_planes(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key == "square") {
    options.set_square(value);
    return true;
  }
  return apply(key, value, options, planes_rows()) ||
         apply(key, value, options.resample, stages::resample_option_table()) ||
         apply(key, value, options.squares, stages::square_plane_option_table()) ||
         apply(key, value, options.superclusters, stages::supercluster_option_table());
}

bool apply_register(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key == "scale") {
    const auto scale = detail::checked_text(key, {"fixed", "free"}, value);
    options.icp.free_scale = options.landmarks.free_scale = options.alignment.free_scale = scale == "free";
    return true;
  }
  if (key == "write" && std::holds_alternative<std::string>(value))
    registered_formats(std::get<std::string>(value));
  return apply(key, value, options.landmarks, landmark_rows()) ||
         apply(key, value, options, register_rows()) ||
         apply(key, value, options.icp, stages::icp_option_table()) ||
         apply(key, value, options.alignment, stages::automatic_option_table()) ||
         apply(key, value, options.faces, stages::face_offset_option_table());
}

bool apply_edit(StageOptions& options, const std::string& key, const OptionValue& value) {
  const auto& lists = io::scene_edit_keys();
  if (std::find(lists.begin(), lists.end(), key) != lists.end())
    fail_input("{}: a list of edits belongs into the scene file", key);
  return apply(key, value, options.edit, stages::opening_option_table()) ||
         apply(key, value, options.displacement, stages::displacement_option_table());
}

bool apply_render(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key == "sigma_px") {
    stages::set_sigma(options.render, value);
    return true;
  }
  return apply(key, value, options.render, stages::render_option_table()) ||
         apply(key, value, options.coverage, stages::coverage_option_table());
}

bool apply_export(StageOptions& options, const std::string& key, const OptionValue& value) {
  return set_export_option(options.exporting, key, value);
}

// A section of options in the scene file and on the command line.
struct Section {
  std::string name;
  const io::SceneOptions io::SceneFile::*written;
  bool (*apply_key)(StageOptions&, const std::string& key, const OptionValue&);
  std::vector<std::string_view> known;  // its keys, for the error that rejects another
};

// Tables may share an option: each name once, in the order given.
std::vector<std::string_view> names_of(const std::vector<std::vector<std::string_view>>& lists) {
  std::vector<std::string_view> names;
  for (const auto& list : lists)
    for (const std::string_view name : list)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"planes", &io::SceneFile::planes, apply_planes,
       names_of({{"square"},
                 option_names(planes_rows()),
                 option_names(stages::resample_option_table()),
                 option_names(stages::square_plane_option_table()),
                 option_names(stages::supercluster_option_table())})},
      {"register", &io::SceneFile::registration, apply_register,
       names_of({{"scale"},
                 option_names(landmark_rows()),
                 option_names(register_rows()),
                 option_names(stages::icp_option_table()),
                 option_names(stages::automatic_option_table()),
                 option_names(stages::face_offset_option_table())})},
      {"edit", &io::SceneFile::edit, apply_edit,
       names_of({option_names(stages::opening_option_table()),
                 option_names(stages::displacement_option_table()), io::scene_edit_keys()})},
      {"render", &io::SceneFile::render, apply_render,
       names_of(
           {option_names(stages::render_option_table()), option_names(stages::coverage_option_table())})},
      {"export", &io::SceneFile::exporting, apply_export, export_option_names()},
  };
  return all;
}

void apply_key(StageOptions& options, const Section& section, const std::string& key,
               const OptionValue& value) {
  if (!section.apply_key(options, key, value)) fail_input("{}", unknown_name("key", key, section.known));
}

// A value as it stands on the command line: true, false, a number, else text, with or without quotes.
OptionValue parse_value(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  const char* const end = text.data() + text.size();
  std::int64_t whole = 0;
  if (const auto parsed = std::from_chars(text.data(), end, whole);
      parsed.ec == std::errc() && parsed.ptr == end)
    return whole;
  double number = 0;
  if (const auto parsed = std::from_chars(text.data(), end, number);
      parsed.ec == std::errc() && parsed.ptr == end)
    return number;
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') return text.substr(1, text.size() - 2);
  return text;
}

template <typename T>
Json describe_table(const T& options, const std::vector<OptionRow<T>>& table) {
  Json json = Json::object();
  for (const auto& row : table)
    if (row.name != "tile")  // changes no result, so it must not change summary.json
      std::visit([&](const auto& value) { json[std::string(row.name)] = value; }, get_option(options, row));
  return json;
}

// The rows whose keys the section does not have yet.
template <typename T>
void add_notes(const std::string& section, const T& defaults, const std::vector<OptionRow<T>>& table,
               std::vector<OptionNote>& notes) {
  for (const auto& row : table) {
    const std::string key(row.name);
    if (std::any_of(notes.begin(), notes.end(),
                    [&](const OptionNote& note) { return note.section == section && note.key == key; }))
      continue;
    OptionNote note;
    note.section = section;
    note.key = key;
    note.unit = row.unit;
    std::visit([&](const auto& value) { note.value = value; }, get_option(defaults, row));
    note.is_number = note.value.is_number();
    note.least = row.minimum;
    note.most = row.maximum;
    note.choices.assign(row.choices.begin(), row.choices.end());
    note.help = row.help;
    notes.push_back(std::move(note));
  }
}

std::vector<OptionNote> notes_of_all_tables() {
  const StageOptions defaults;
  std::vector<OptionNote> notes;
  add_notes("planes", defaults, planes_rows(), notes);
  add_notes("planes", defaults.resample, stages::resample_option_table(), notes);
  add_notes("planes", defaults.squares, stages::square_plane_option_table(), notes);
  add_notes("planes", defaults.superclusters, stages::supercluster_option_table(), notes);
  notes.push_back({"register",
                   "scale",
                   "fixed",
                   "",
                   false,
                   0,
                   0,
                   {"fixed", "free"},
                   "whether ICP and landmarks find the scans' scale, too"});
  add_notes("register", defaults.landmarks, landmark_rows(), notes);
  add_notes("register", defaults, register_rows(), notes);
  add_notes("register", defaults.icp, stages::icp_option_table(), notes);
  add_notes("register", defaults.alignment, stages::automatic_option_table(), notes);
  add_notes("register", defaults.faces, stages::face_offset_option_table(), notes);
  add_notes("edit", defaults.edit, stages::opening_option_table(), notes);
  add_notes("edit", defaults.displacement, stages::displacement_option_table(), notes);
  add_notes("render", defaults.render, stages::render_option_table(), notes);
  add_notes("render", defaults.coverage, stages::coverage_option_table(), notes);
  add_notes("export", defaults.exporting, export_option_table(), notes);
  add_notes("export", defaults.exporting.atlas, stages::atlas_option_table(), notes);
  // What is "auto" by default is so there.
  const Json used = describe(defaults);
  for (OptionNote& note : notes)
    if (const Json& section = used.at(note.section); section.contains(note.key))
      note.value = section.at(note.key);
  // [scene] levelled, unless it is given.
  for (OptionNote& note : notes)
    if (note.section == "register" && note.key == "levelled") note.value = nullptr;
  return notes;
}

}  // namespace

std::vector<std::string> option_sections() {
  std::vector<std::string> names;
  for (const Section& section : sections()) names.push_back(section.name);
  return names;
}

std::vector<OptionNote> option_notes(const std::vector<std::string>& of_sections) {
  std::vector<OptionNote> notes = notes_of_all_tables();
  std::erase_if(notes, [&](const OptionNote& note) {
    return !of_sections.empty() &&
           std::find(of_sections.begin(), of_sections.end(), note.section) == of_sections.end();
  });
  return notes;
}

void StageOptions::set_tile(int tile) {
  resample.tile = squares.tile = superclusters.tile = contours.tile = decimate.tile = stray.tile = tile;
}

void StageOptions::set_seed(int seed) {
  squares.seed = icp.seed = alignment.seed = seed;
}

void StageOptions::set_square(const OptionValue& value) {
  if (auto text = std::get_if<std::string>(&value); text && *text == "auto") {
    auto_square = true;
    return;
  }
  const auto* row = find_option(stages::square_plane_option_table(), "square");
  set_option(squares, *row, value);
  auto_square = false;
}

void StageOptions::apply(const std::string& assignment) {
  const auto dot = assignment.find('.'), equals = assignment.find('=');
  if (dot == std::string::npos || equals == std::string::npos || dot > equals)
    fail_input("expected SECTION.KEY=VALUE, such as render.blend=linear");
  const std::string name = assignment.substr(0, dot), key = assignment.substr(dot + 1, equals - dot - 1);
  const auto section =
      std::find_if(sections().begin(), sections().end(), [&](const auto& s) { return s.name == name; });
  if (section == sections().end())
    fail_input("unknown section '{}'; expected planes, register, edit, render or export", name);
  apply_key(*this, *section, key, parse_value(assignment.substr(equals + 1)));
}

void StageOptions::set(const std::string& assignment) {
  try {
    apply(assignment);
  } catch (const Error& error) {
    fail(ErrorKind::usage, "--set {}: {}", assignment, error.what());
  }
}

StageOptions read_stage_options(const io::SceneFile& scene, const std::vector<std::string>& assignments) {
  StageOptions options;
  options.alignment.levelled = scene.levelled;
  for (const auto& section : sections())
    for (const auto& [key, option] : scene.*section.written)
      with_context(fmt::format("{}:{}: [{}]", scene.path.string(), option.line, section.name),
                   [&, &k = key, &o = option] { apply_key(options, section, k, o.value); });
  for (const auto& assignment : assignments) options.set(assignment);
  return options;
}

bool asks_for_export(const io::SceneFile& scene, const std::vector<std::string>& assignments) {
  return scene.has_export || std::any_of(assignments.begin(), assignments.end(), [](const auto& assignment) {
           return assignment.starts_with("export.");
         });
}

nlohmann::ordered_json describe(const StageOptions& options) {
  Json planes = describe_table(options.resample, stages::resample_option_table());
  planes.update(describe_table(options.squares, stages::square_plane_option_table()));
  planes.update(describe_table(options.superclusters, stages::supercluster_option_table()));
  if (options.auto_square) planes["square"] = "auto";
  planes.update(describe_table(options, planes_rows()));
  Json registration = describe_table(options.icp, stages::icp_option_table());
  registration.update(describe_table(options.landmarks, landmark_rows()));
  registration.update(describe_table(options, register_rows()));
  registration.update(describe_table(options.alignment, stages::automatic_option_table()));
  Json edit = describe_table(options.edit, stages::opening_option_table());
  edit.update(describe_table(options.displacement, stages::displacement_option_table()));
  Json render = describe_table(options.render, stages::render_option_table());
  if (options.render.auto_sigma) render["sigma_px"] = "auto";
  render.update(describe_table(options.coverage, stages::coverage_option_table()));
  registration.update(describe_table(options.faces, stages::face_offset_option_table()));
  registration["scale"] = options.icp.free_scale ? "free" : "fixed";
  Json exporting = describe_table(options.exporting, export_option_table());
  exporting.update(describe_table(options.exporting.atlas, stages::atlas_option_table()));
  return {{"planes", planes},
          {"register", registration},
          {"edit", edit},
          {"render", render},
          {"export", exporting}};
}

}  // namespace hybrid::batch
