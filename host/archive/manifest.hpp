#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "archive/build_identity.hpp"
#include "archive/input_cache.hpp"
#include "archive/walk.hpp"
#include "geometry/vectors.hpp"
#include "io/scene/profile_file.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::archive {

enum class UnitKind { planes, scene, report };
const char* name_of(UnitKind kind);

// One piece of work, done by one process at a time, whose result is a function of its key.
struct Unit {
  std::size_t index = 0;   // in Manifest::units
  std::size_t number = 0;  // in the plan: what --unit takes; differs where a part of the plan was read
  UnitKind kind = UnitKind::planes;
  std::string id;                  // "planes abbey west", "scene abbey", "planes loose/a.e57 a-0", "report"
  std::string key;                 // its object in the store, once units that it needs are done (outcome.hpp)
  std::string result;              // its link below results/; "" for what only a scene needs
  std::vector<std::size_t> needs;  // units before this one
  double estimate_s = 0;           // CPU seconds on one core
  std::uint64_t estimate_bytes = 0;
  std::string from;  // what the key is made of, a JSON text: inputs' hashes, options, build
  std::vector<Input> inputs;

  std::filesystem::path scene;  // of scene units and of planes that belong to one, else ""
  bool implied =
      false;  // `scene` is no file but a folder or file of loose scans (io/scene/implied_scene.hpp)
  std::vector<std::filesystem::path> scans;  // scene units that are implied: the scans' files
  std::filesystem::path file;                // planes: the scan's
  std::size_t scan_index = 0;                // planes: in the file
  std::size_t entry = 0;                     // planes of a scene: the [[scan]]
  std::string scan_id;                       // planes
  io::ProfileSettings settings;
};

// The scene file, or what loose scans imply. Throws as io::read_scene_file().
io::SceneFile scene_of(const Unit& unit);

// The plan of a night. In the order of units: planes, scenes, then the report; so the units of one kind are
// one range of indices, and a unit needs only earlier ones.
struct Manifest {
  std::filesystem::path archive;  // absolute
  BuildIdentity build;
  std::vector<Remark> problems, notes;
  std::vector<Unit> units;
};

// Its text is the same for the same archive, profile and program: a JSON document in which each unit stands
// on two lines, what its schedule needs and the rest, and a table of fixed width tells where
// (manifest_file.cpp).
std::string to_text(const Manifest& manifest);

// Without: settings, inputs and from stay empty. What a schedule needs is a tenth of the file.
enum class Detail { all, schedule };
// All of these throw ErrorKind::input when the file is none of this version, or not whole.
Manifest read_manifest(const std::filesystem::path& file, Detail detail = Detail::all);
// Of a plan of any size only these units, and those that they need without detail; in the order of the plan.
// Reads the bytes of these units alone.
Manifest read_units(const std::filesystem::path& file, const std::vector<std::size_t>& numbers,
                    Detail detail = Detail::all);
// All but the units.
Manifest read_manifest_head(const std::filesystem::path& file);
std::size_t count_units(const std::filesystem::path& file);

// A unit as JSON: `head` what its schedule needs, `rest` the others.
struct UnitJson {
  nlohmann::ordered_json head, rest;
};
UnitJson to_json(const Unit& unit);
// Empty `rest`: without detail.
Unit unit_from(const nlohmann::ordered_json& head, const nlohmann::ordered_json& rest);
nlohmann::ordered_json to_json(const std::vector<Remark>& remarks);
std::vector<Remark> remarks_from(const nlohmann::ordered_json& json);

}  // namespace hybrid::archive
