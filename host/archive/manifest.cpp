#include "archive/manifest.hpp"

#include "core/error.hpp"
#include "io/scene/implied_scene.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;

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

UnitKind kind_from(const std::string& name) {
  for (const UnitKind kind : {UnitKind::planes, UnitKind::scene, UnitKind::report})
    if (name == name_of(kind)) return kind;
  fail_input("unit of kind {}: expected planes, scene or report", name);
}

}  // namespace

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

UnitJson to_json(const Unit& unit) {
  UnitJson json;
  json.head = {{"number", unit.number},
               {"kind", name_of(unit.kind)},
               {"id", unit.id},
               {"key", unit.key},
               {"needs", unit.needs},
               {"estimate", {{"cpu_s", unit.estimate_s}, {"memory_bytes", unit.estimate_bytes}}}};
  if (!unit.result.empty()) json.head["result"] = unit.result;
  if (!unit.scene.empty()) json.head["scene"] = unit.scene.string();
  if (unit.implied) json.head["implied"] = true;
  if (unit.kind == UnitKind::planes)
    json.head["scan"] = {{"file", unit.file.string()},
                         {"index", unit.scan_index},
                         {"entry", unit.entry},
                         {"id", unit.scan_id}};
  Json inputs = Json::array();
  for (const Input& input : unit.inputs) inputs.push_back(archive::to_json(input));
  json.rest = {{"settings", to_json(unit.settings)}, {"inputs", inputs}, {"from", Json::parse(unit.from)}};
  for (const auto& file : unit.scans) json.rest["scans"].push_back(file.string());
  return json;
}

Unit unit_from(const Json& head, const Json& rest) {
  Unit unit;
  unit.index = unit.number = head.at("number");
  unit.kind = kind_from(head.at("kind"));
  unit.id = head.at("id");
  unit.key = head.at("key");
  unit.result = head.value("result", "");
  unit.needs = head.at("needs").get<std::vector<std::size_t>>();
  unit.estimate_s = head.at("estimate").at("cpu_s");
  unit.estimate_bytes = head.at("estimate").at("memory_bytes");
  unit.scene = head.value("scene", "");
  unit.implied = head.value("implied", false);
  if (head.contains("scan")) {
    unit.file = head["scan"].at("file").get<std::string>();
    unit.scan_index = head["scan"].at("index");
    unit.entry = head["scan"].at("entry");
    unit.scan_id = head["scan"].at("id");
  }
  if (rest.empty()) return unit;
  unit.settings = settings_from(rest.at("settings"));
  if (rest.contains("scans"))
    for (const auto& file : rest["scans"]) unit.scans.emplace_back(file.get<std::string>());
  for (const auto& input : rest.at("inputs")) unit.inputs.push_back(input_from_json(input));
  unit.from = rest.at("from").dump();
  return unit;
}

io::SceneFile scene_of(const Unit& unit) {
  if (!unit.implied) return io::read_scene_file(unit.scene);
  return io::implied_scene(unit.scene, unit.kind == UnitKind::planes ? std::vector{unit.file} : unit.scans);
}

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

}  // namespace hybrid::archive
