#pragma once
#include <cstdint>
#include <vector>

#include "score/measure/joined_scan.hpp"

namespace score {

// A true plane that counts and the region that shares most samples with it.
struct PlaneRow {
  std::uint32_t plane = 0;
  std::int64_t samples = 0;     // measured, of the plane
  std::uint32_t region = 0;     // 0: none shares any
  std::int64_t common = 0;      // of the plane's samples in that region
  std::int64_t unlabelled = 0;  // of the plane's samples in no region
  std::int64_t of_region = 0;   // the region's samples, as Hoover's rows count them
  std::int64_t strangers = 0;   // of these, on other planes
  std::int64_t curved = 0;      // of these, curved or cluttered
  std::int64_t mixed = 0;       // of these, mixed or ghosts
  double share_of_plane() const { return static_cast<double>(common) / static_cast<double>(samples); }
  double share_of_region() const {
    return of_region > 0 ? static_cast<double>(common) / static_cast<double>(of_region) : 0;
  }
};

// By the smaller of the two shares, the worst first; of equals the one with more samples.
std::vector<PlaneRow> list_planes(const JoinedScan& scan);

}  // namespace score
