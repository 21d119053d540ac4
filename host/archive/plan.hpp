#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "archive/manifest.hpp"
#include "io/scene/profile_file.hpp"

namespace hybrid::archive {

struct PlanRequest {
  std::filesystem::path archive;
  std::optional<std::filesystem::path> profile;  // io::ProfileFile
  BuildIdentity build;
};

// A profile whose options exist and have values that they can have. Throws ErrorKind::input naming its line.
io::ProfileFile read_profile(const std::filesystem::path& file);

// Walks the archive and makes the units of all its scenes and loose scans. What cannot be used is a problem
// of the manifest, the rest is planned; a scene that cannot be read is a unit, whose run tells why, again and
// again until it is mended. Throws ErrorKind::input when the archive cannot be read, and for the profile.
Manifest make_plan(const PlanRequest& request, InputCache& cache);

// For people: what was found, and the work by kind.
std::string describe(const Manifest& manifest);
// For people: a line per unit: number, kind, estimate, numbers of the units that it needs, id and file.
std::string list_units(const Manifest& manifest);
// For --json.
nlohmann::ordered_json summary(const Manifest& manifest);

}  // namespace hybrid::archive
