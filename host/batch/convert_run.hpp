#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batch/dry_run.hpp"

namespace hybrid::batch {

struct ConvertRequest {
  std::filesystem::path in, out;
  std::vector<std::filesystem::path> more{};  // further inputs, whose scans follow
  std::optional<std::size_t> index;           // one scan of the file; all without it
  bool force = false;                         // replace files
  bool salvage = false;                       // of damaged scans what is good (io::ReadOptions)
};

struct ConvertRun {
  nlohmann::ordered_json summary;  // input; outputs with their scans, what was dropped and changed; failures
  int exit_code = 0;               // 3 when some scans failed
};

// Writes a file's scans in the format of the other's extension, one open at a time. Several scans go
// into one file where its format holds several, else into numbered ones (a-0.ply, a-1.ply); those of several
// files into one that holds several, range images with records into the E57 file that they were made from.
// What the format cannot hold is named by a warning. Between E57 files and range images with records
// everything is kept as it is stored (convert_records.hpp). A scan that cannot be read does not stop the
// others; when none can, nothing is written. Throws ErrorKind::usage: no such format, a file that is there
// (without force) or is the input.
ConvertRun run_convert(const ConvertRequest& request);

// --dry-run: the same checks; says what would be written.
DryRun try_convert(const ConvertRequest& request);

std::string text_of(const ConvertRun& run);

}  // namespace hybrid::batch
