#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/scan_unit.hpp"
#include "io/scan_frame.hpp"

namespace hybrid::batch {

struct PlanesRequest {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
  StageOptions options;
  double unit_m = 1;  // of the files' lengths
  io::ScanAxes axes = io::ScanAxes::z_up;
  std::optional<Vec3> scanner;      // where it stood, in the files' coordinates (io::place_scanner)
  std::optional<std::size_t> only;  // this scan of each file alone, under the id that it has among all
  bool salvage = false;             // of damaged scans what is good (io::ReadOptions)
  bool quiet = false;
  bool force = false;  // write into the output folder of a scene
};

struct PlanesRun {
  nlohmann::ordered_json summary;  // also written to out/summary.json
  int exit_code = 0;               // 0, 3 when some scans failed, the failure's own code when all did
};

// Planes, contours and decimation of every scan in the files, each written to out/scans/<id>/ as soon as it
// is done; one scan is in memory at a time, and one that fails does not stop the others.
PlanesRun run_planes(device::Queue& queue, const PlanesRequest& request);

// A table for a person.
std::string text_of(const PlanesRun& run);

}  // namespace hybrid::batch
