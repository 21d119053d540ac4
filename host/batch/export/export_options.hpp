#pragma once
#include <set>
#include <string>

#include "stages/rendering/bake_atlas.hpp"

namespace hybrid::batch {

// [export] of the scene file.
struct ExportOptions {
  std::string formats = "all";         // "all", or names of kExportFormats with blanks or commas between
  std::string picture = "png";         // of the atlas: "png" | "jpeg"
  std::string rib_samples = "points";  // "points" | "spheres"
  stages::AtlasOptions atlas;
};

inline const std::set<std::string> kExportFormats = {"glb", "obj",    "ply", "las",
                                                     "e57", "colmap", "st",  "rib"};

const std::vector<OptionRow<ExportOptions>>& export_option_table();  // without the atlas's

// What `formats` says. Throws ErrorKind::input naming the word that is no format.
std::set<std::string> wanted_formats(const ExportOptions& options);

}  // namespace hybrid::batch
