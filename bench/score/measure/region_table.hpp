#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "score/measure/joined_scan.hpp"

namespace score {

enum class Planes { all, that_count };

// How many samples each pair of a result's region and a true plane share. Planes::that_count leaves the
// samples of all other planes out altogether, of the regions' sizes too.
struct RegionTable {
  struct Overlap {
    std::uint32_t region, plane;
    std::int64_t samples;
  };
  std::vector<Overlap> overlaps;                      // by region, then plane
  std::map<std::uint32_t, std::int64_t> region_size;  // curved and mixed samples included
  std::map<std::uint32_t, std::int64_t> plane_size;

  // The plane most of a region's planar samples lie on; of equals the smallest id. Regions without any are
  // absent.
  std::map<std::uint32_t, std::uint32_t> majority() const;
};
RegionTable count_overlaps(const JoinedScan& scan, Planes which);

}  // namespace score
