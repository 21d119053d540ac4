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
#include "io/profile_file.hpp"

namespace hybrid::archive {

enum class UnitKind { planes, scene, report };
const char* name_of(UnitKind kind);

// One piece of work, done by one process at a time, whose result is a function of its key.
struct Unit {
  std::size_t index = 0;  // in the manifest: what --unit takes
  UnitKind kind = UnitKind::planes;
  std::string id;      // "planes abbey/scene.toml west", "scene abbey", "planes loose/a.e57 a-0", "report"
  std::string key;     // its object in the store, once units that it needs are done (outcome.hpp)
  std::string result;  // its link below results/; "" for what only a scene needs
  std::vector<std::size_t> needs;  // units before this one
  double estimate_s = 0;           // CPU seconds on one core
  std::uint64_t estimate_bytes = 0;
  std::vector<Input> inputs;
  nlohmann::ordered_json from;  // what the key is made of: inputs' hashes, options, build

  std::filesystem::path scene;  // of scene units and of planes that belong to one, else ""
  std::filesystem::path file;   // planes: the scan's
  std::size_t scan_index = 0;   // planes: in the file
  std::size_t entry = 0;        // planes of a scene: the [[scan]]
  std::string scan_id;          // planes
  io::ProfileSettings settings;
};

// The plan of a night. In the order of units: planes, scenes, then the report; so the units of one kind are
// one range of indices, and a unit needs only earlier ones.
struct Manifest {
  std::filesystem::path archive;  // absolute
  BuildIdentity build;
  std::vector<Remark> problems, notes;
  std::vector<Unit> units;
};

// Its text is the same for the same archive, profile and program.
std::string to_text(const Manifest& manifest);
// Throws ErrorKind::input when the file is none of this version.
Manifest read_manifest(const std::filesystem::path& file);

}  // namespace hybrid::archive
