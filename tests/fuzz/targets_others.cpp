// Models, cameras, scene files, photographs, truth: from the samples of the table of bad input.
#include "fuzz/check_scan.hpp"
#include "fuzz/targets.hpp"
#include "io/reader_rows.hpp"

namespace hybrid::testing {

std::vector<FuzzTarget> other_fuzz_targets() {
  std::vector<FuzzTarget> targets;
  for (const auto& rows : {text_reader_rows(), camera_reader_rows(), image_reader_rows()})
    for (const ReaderRow& row : rows) {
      if (row.name == "range_exr_as_scan" || row.name == "foreign_exr") continue;  // have their own
      const std::string name = row.name == "range_exr" ? "range_exr_strict" : row.name;
      targets.push_back(
          {name, row.file, 4096,
           [row](const auto& folder) { return std::vector<std::string>{row.good(folder)}; },
           [row](const auto& file, std::string_view) { unless_refused([&] { return row.read(file); }); }});
    }
  return targets;
}

}  // namespace hybrid::testing
