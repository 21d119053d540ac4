#include "batch/export/export_options.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace hybrid::batch {

const std::vector<OptionRow<ExportOptions>>& export_option_table() {
  using O = ExportOptions;
  static const std::vector<OptionRow<O>> table = {
      {"formats", "", &O::formats, 0, 0,
       "what is written: all, or some of glb obj ply las e57 colmap st rib, separated by blanks or commas"},
      {"picture", "", &O::picture, 0, 0, "format of the atlas pages", {"png", "jpeg"}},
      {"rib_samples", "", &O::rib_samples, 0, 0, "retained samples in RIB", {"points", "spheres"}},
  };
  return table;
}

std::set<std::string> wanted_formats(const ExportOptions& options) {
  std::set<std::string> formats;
  std::string text = options.formats + ",", word;
  for (const char c : text) {
    if (c != ',' && c != ' ') {
      word += c;
      continue;
    }
    if (word == "all")
      formats = kExportFormats;
    else if (kExportFormats.count(word))
      formats.insert(word);
    else if (!word.empty())
      fail_input("formats: expected all, or some of {}, found \"{}\"", fmt::join(kExportFormats, ", "), word);
    word.clear();
  }
  if (formats.empty())
    fail_input("formats: expected all, or some of {}, found nothing", fmt::join(kExportFormats, ", "));
  return formats;
}

}  // namespace hybrid::batch
