#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/plane.hpp"
#include "geometry/pose.hpp"

namespace hybrid::io {

// What hybrid-synth knows about one of its scans; per input sample (indexed by `source`).
struct ScanTruth {
  std::string id;
  Pose world_from_scan;
  std::vector<std::uint32_t> plane;  // true plane id, 0 = none
  std::vector<std::uint32_t> kind;   // 0 planar, 1 curved, 2 mixed (several surfaces in the beam's footprint)
};

struct SceneTruth {
  std::vector<ScanTruth> scans;
};

// truth.json and the EXR images it names. Throws ErrorKind::input naming the file and the missing part.
SceneTruth read_truth(const std::filesystem::path& file);

}  // namespace hybrid::io
