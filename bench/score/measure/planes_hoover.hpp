#pragma once
#include <array>
#include <map>
#include <vector>

#include "score/geometry.hpp"
#include "score/measure/region_table.hpp"

namespace score {

// A. Hoover et al., An experimental comparison of range image segmentation algorithms, PAMI 18(7), 1996,
// section 4.
struct HooverScore {
  double overlap = 0;  // the tolerance T: what two regions must share at least
  int planes = 0;      // true ones that count
  int correct = 0;
  int over_segmented = 0;          // true planes that several regions share
  int under_segmented = 0;         // regions that cover several true planes
  int planes_under_segmented = 0;  // those planes: correct + over + this + missed = planes
  int missed = 0;
  int noise = 0;        // regions that stand for no plane
  int small_noise = 0;  // of these, with fewer samples than a plane needs to count
  int angles = 0;       // correct planes whose direction is known on both sides
  double mean_angle_deg = 0;
  std::map<std::uint32_t, std::uint32_t> region_of_plane;  // the correct ones
};

inline constexpr std::array<double, 7> kHooverOverlaps{0.51, 0.60, 0.70, 0.75, 0.80, 0.90, 0.95};

using Normals = std::map<std::uint32_t, Vec3>;

// overlap > 0.5. Where two mappings claim one region, the one with the larger mean share holds.
HooverScore score_hoover(const RegionTable& table, double overlap, std::int64_t min_samples,
                         const Normals& region_normals, const Normals& plane_normals);

}  // namespace score
