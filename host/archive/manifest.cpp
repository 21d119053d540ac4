#include "archive/manifest.hpp"

#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "hybrid manifest 1";

Json to_json(const std::vector<Remark>& remarks) {
  Json list = Json::array();
  for (const auto& [path, what] : remarks) list.push_back({{"path", path}, {"what", what}});
  return list;
}

std::vector<Remark> remarks_from(const Json& json) {
  std::vector<Remark> list;
  for (const auto& one : json) list.push_back({one.at("path"), one.at("what")});
  return list;
}

Json to_json(const io::ProfileSettings& settings) {
  Json json = {{"assignments", settings.assignments}};
  if (settings.salvage) json["salvage"] = *settings.salvage;
  if (settings.leave_one_out) json["leave_one_out"] = *settings.leave_one_out;
  if (settings.seed) json["seed"] = *settings.seed;
  return json;
}

io::ProfileSettings settings_from(const Json& json) {
  io::ProfileSettings settings;
  settings.assignments = json.at("assignments").get<std::vector<std::string>>();
  if (json.contains("salvage")) settings.salvage = json["salvage"].get<bool>();
  if (json.contains("leave_one_out")) settings.leave_one_out = json["leave_one_out"].get<bool>();
  if (json.contains("seed")) settings.seed = json["seed"].get<int>();
  return settings;
}

Json to_json(const Unit& unit) {
  Json inputs = Json::array();
  for (const Input& input : unit.inputs) inputs.push_back(archive::to_json(input));
  Json json = {{"index", unit.index},
               {"kind", name_of(unit.kind)},
               {"id", unit.id},
               {"key", unit.key},
               {"needs", unit.needs},
               {"estimate", {{"cpu_s", unit.estimate_s}, {"memory_bytes", unit.estimate_bytes}}},
               {"settings", to_json(unit.settings)},
               {"inputs", inputs},
               {"from", unit.from}};
  if (!unit.result.empty()) json["result"] = unit.result;
  if (!unit.scene.empty()) json["scene"] = unit.scene.string();
  if (unit.kind == UnitKind::planes)
    json["scan"] = {{"file", unit.file.string()},
                    {"index", unit.scan_index},
                    {"entry", unit.entry},
                    {"id", unit.scan_id}};
  return json;
}

UnitKind kind_from(const std::string& name) {
  for (const UnitKind kind : {UnitKind::planes, UnitKind::scene, UnitKind::report})
    if (name == name_of(kind)) return kind;
  fail_input("unit of kind {}: expected planes, scene or report", name);
}

Unit unit_from(const Json& json) {
  Unit unit;
  unit.index = json.at("index");
  unit.kind = kind_from(json.at("kind"));
  unit.id = json.at("id");
  unit.key = json.at("key");
  unit.result = json.value("result", "");
  unit.needs = json.at("needs").get<std::vector<std::size_t>>();
  unit.estimate_s = json.at("estimate").at("cpu_s");
  unit.estimate_bytes = json.at("estimate").at("memory_bytes");
  unit.settings = settings_from(json.at("settings"));
  for (const auto& input : json.at("inputs")) unit.inputs.push_back(input_from_json(input));
  unit.from = json.at("from");
  unit.scene = json.value("scene", "");
  if (json.contains("scan")) {
    unit.file = json["scan"].at("file").get<std::string>();
    unit.scan_index = json["scan"].at("index");
    unit.entry = json["scan"].at("entry");
    unit.scan_id = json["scan"].at("id");
  }
  return unit;
}

}  // namespace

const char* name_of(UnitKind kind) {
  switch (kind) {
    case UnitKind::planes:
      return "planes";
    case UnitKind::scene:
      return "scene";
    default:
      return "report";
  }
}

std::string to_text(const Manifest& manifest) {
  Json units = Json::array();
  for (const Unit& unit : manifest.units) units.push_back(to_json(unit));
  const Json json = {{"format", kFormat},
                     {"archive", manifest.archive.string()},
                     {"build", to_json(manifest.build)},
                     {"problems", to_json(manifest.problems)},
                     {"notes", to_json(manifest.notes)},
                     {"units", units}};
  return json.dump(1) + "\n";
}

Manifest read_manifest(const std::filesystem::path& file) {
  const Json json = Json::parse(io::read_text(file), nullptr, false);
  if (!json.is_object() || json.value("format", "") != kFormat)
    fail_input("{}: expected \"{}\", found something else; make the plan again", file.string(), kFormat);
  try {
    Manifest manifest;
    manifest.archive = json.at("archive").get<std::string>();
    manifest.build = identity_from_json(json.at("build"));
    manifest.problems = remarks_from(json.at("problems"));
    manifest.notes = remarks_from(json.at("notes"));
    for (const auto& unit : json.at("units")) manifest.units.push_back(unit_from(unit));
    for (std::size_t i = 0; i < manifest.units.size(); ++i) {
      const Unit& unit = manifest.units[i];
      if (unit.index != i || unit.key.size() != 32)
        fail_input("{}: unit {}: no such index or key; make the plan again", file.string(), i);
      for (const std::size_t need : unit.needs)
        if (need >= i) fail_input("{}: unit {}: needs a later one; make the plan again", file.string(), i);
    }
    return manifest;
  } catch (const nlohmann::json::exception& error) {
    fail_input("{}: not a whole manifest ({}); make the plan again", file.string(), error.what());
  }
}

}  // namespace hybrid::archive
