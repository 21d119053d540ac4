#include "batch/stage_options.hpp"

#include <algorithm>
#include <charconv>
#include <functional>

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

// A table of options, whatever part of all options it is of.
struct Table {
  std::vector<std::string_view> names;
  // False where the table has no such key.
  std::function<bool(StageOptions&, const std::string& key, const OptionValue&)> set;
  std::function<void(const StageOptions&, Json&)> describe;
  std::function<void(const std::string& section, std::vector<OptionNote>&)> add_notes;
};

template <typename T>
Json describe_rows(const T& options, const std::vector<OptionRow<T>>& rows) {
  Json json = Json::object();
  for (const auto& row : rows)
    if (row.name != "tile")  // changes no result, so it must not change summary.json
      std::visit([&](const auto& value) { json[std::string(row.name)] = value; }, get_option(options, row));
  return json;
}

// The rows whose keys the section does not have yet.
template <typename T>
void add_notes(const std::string& section, const T& defaults, const std::vector<OptionRow<T>>& rows,
               std::vector<OptionNote>& notes) {
  for (const auto& row : rows) {
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

// `part`: of all options, const or not, those that the rows are of.
template <typename T, typename Part>
Table table_of(const std::vector<OptionRow<T>>& rows, Part part) {
  return {option_names(rows),
          [&rows, part](StageOptions& options, const std::string& key, const OptionValue& value) {
            const auto* row = find_option(rows, key);
            if (row) set_option(part(options), *row, value);
            return row != nullptr;
          },
          [&rows, part](const StageOptions& options, Json& json) {
            json.update(describe_rows(part(options), rows));
          },
          [&rows, part](const std::string& section, std::vector<OptionNote>& notes) {
            const StageOptions defaults;
            add_notes(section, part(defaults), rows, notes);
          }};
}

// What a section has besides tables: keys of its own, asked first; false where there is none of that name.
bool set_planes_key(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key != "square") return false;
  options.set_square(value);
  return true;
}

bool set_register_key(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key == "write" && std::holds_alternative<std::string>(value))
    registered_formats(std::get<std::string>(value));
  if (key != "scale") return false;
  const auto scale = detail::checked_text(key, {"fixed", "free"}, value);
  options.icp.free_scale = options.landmarks.free_scale = options.alignment.free_scale = scale == "free";
  return true;
}

bool set_edit_key(StageOptions&, const std::string& key, const OptionValue&) {
  const auto& lists = io::scene_edit_keys();
  if (std::find(lists.begin(), lists.end(), key) != lists.end())
    fail_input("{}: a list of edits belongs into the scene file", key);
  return false;
}

bool set_render_key(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key != "sigma_px") return false;
  stages::set_sigma(options.render, value);
  return true;
}

bool set_export_key(StageOptions& options, const std::string& key, const OptionValue& value) {
  if (key != "formats" || !std::holds_alternative<std::string>(value)) return false;
  options.exporting.formats = std::get<std::string>(value);
  wanted_formats(options.exporting);  // or what is none
  return true;
}

// A section of options in the scene file and on the command line.
struct Section {
  std::string name;
  const io::SceneOptions io::SceneFile::*written;
  bool (*set_own)(StageOptions&, const std::string& key, const OptionValue&);
  std::vector<std::string_view> own;  // for the error that rejects another
  std::vector<Table> tables;          // they may share a key: the first one's is set

  // Each name once.
  std::vector<std::string_view> names() const {
    std::vector<std::string_view> all = own;
    for (const Table& table : tables)
      for (const std::string_view key : table.names)
        if (std::find(all.begin(), all.end(), key) == all.end()) all.push_back(key);
    return all;
  }
  void set(StageOptions& options, const std::string& key, const OptionValue& value) const {
    if (set_own(options, key, value)) return;
    if (std::none_of(tables.begin(), tables.end(),
                     [&](const Table& table) { return table.set(options, key, value); }))
      fail_input("{}", unknown_name("key", key, names()));
  }
};

const std::vector<Section>& sections() {
  const auto all_of = [](auto& o) -> auto& {
    return o;
  };
  static const std::vector<Section> all = {
      {"planes",
       &io::SceneFile::planes,
       set_planes_key,
       {"square"},
       {table_of(planes_rows(), all_of),
        table_of(
            stages::resample_option_table(), [](auto& o) -> auto& { return o.resample; }),
        table_of(
            stages::square_plane_option_table(), [](auto& o) -> auto& { return o.squares; }),
        table_of(
            stages::supercluster_option_table(), [](auto& o) -> auto& { return o.superclusters; })}},
      {"register",
       &io::SceneFile::registration,
       set_register_key,
       {"scale"},
       {table_of(
            landmark_rows(), [](auto& o) -> auto& { return o.landmarks; }),
        table_of(register_rows(), all_of),
        table_of(
            stages::icp_option_table(), [](auto& o) -> auto& { return o.icp; }),
        table_of(
            stages::automatic_option_table(), [](auto& o) -> auto& { return o.alignment; }),
        table_of(
            stages::face_offset_option_table(), [](auto& o) -> auto& { return o.faces; })}},
      {"edit",
       &io::SceneFile::edit,
       set_edit_key,
       io::scene_edit_keys(),
       {table_of(
            stages::opening_option_table(), [](auto& o) -> auto& { return o.edit; }),
        table_of(
            stages::displacement_option_table(), [](auto& o) -> auto& { return o.displacement; })}},
      {"render",
       &io::SceneFile::render,
       set_render_key,
       {},
       {table_of(
            stages::render_option_table(), [](auto& o) -> auto& { return o.render; }),
        table_of(
            stages::coverage_option_table(), [](auto& o) -> auto& { return o.coverage; })}},
      {"export",
       &io::SceneFile::exporting,
       set_export_key,
       {},
       {table_of(
            export_option_table(), [](auto& o) -> auto& { return o.exporting; }),
        table_of(
            stages::atlas_option_table(), [](auto& o) -> auto& { return o.exporting.atlas; })}},
  };
  return all;
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

std::vector<OptionNote> notes_of_all_tables() {
  std::vector<OptionNote> notes;
  for (const Section& section : sections()) {
    if (section.name == "register")
      notes.push_back({"register",
                       "scale",
                       "fixed",
                       "",
                       false,
                       0,
                       0,
                       {"fixed", "free"},
                       "whether ICP and landmarks find the scans' scale, too"});
    for (const Table& table : section.tables) table.add_notes(section.name, notes);
  }
  const Json used = describe(StageOptions());
  for (OptionNote& note : notes) {
    if (const Json& section = used.at(note.section); section.contains(note.key))
      note.value = section.at(note.key);  // what is "auto" by default is so there
    if (note.section == "register" && note.key == "levelled")
      note.value = nullptr;  // [scene]'s, unless given
  }
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
  section->set(*this, key, parse_value(assignment.substr(equals + 1)));
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
                   [&, &k = key, &o = option] { section.set(options, k, o.value); });
  for (const auto& assignment : assignments) options.set(assignment);
  return options;
}

bool asks_for_export(const io::SceneFile& scene, const std::vector<std::string>& assignments) {
  return scene.has_export || std::any_of(assignments.begin(), assignments.end(), [](const auto& assignment) {
           return assignment.starts_with("export.");
         });
}

nlohmann::ordered_json describe(const StageOptions& options) {
  Json json = Json::object();
  for (const Section& section : sections()) {
    Json& keys = json[section.name] = Json::object();
    for (const Table& table : section.tables) table.describe(options, keys);
  }
  if (options.auto_square) json["planes"]["square"] = "auto";
  if (options.render.auto_sigma) json["render"]["sigma_px"] = "auto";
  json["register"]["scale"] = options.icp.free_scale ? "free" : "fixed";
  return json;
}

}  // namespace hybrid::batch
