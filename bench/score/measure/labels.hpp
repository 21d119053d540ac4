#pragma once
#include "score/measure/joined_scan.hpp"
#include "score/measure/region_table.hpp"

namespace score {

// METHOD, how results are scored: a planar sample is right when the plane most of its region's planar samples
// lie on is its own.
struct LabelScore {
  std::int64_t planar = 0, right = 0;  // measured samples of all true planes
  std::int64_t planes = 0, found = 0;  // planes that count; found: at least half of their samples right
  std::int64_t curved = 0, curved_called_planar = 0;  // curved or cluttered
  std::int64_t mixed = 0, mixed_called_planar = 0;
  std::int64_t ghosts = 0, ghosts_called_planar = 0;  // behind window glass
  std::vector<std::uint32_t> lost;                    // the planes that were not found
};
LabelScore score_labels(const JoinedScan& scan);

}  // namespace score
