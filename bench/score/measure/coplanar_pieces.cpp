#include "score/measure/coplanar_pieces.hpp"

#include <cmath>

#include "score/measure/region_table.hpp"

namespace score {
namespace {

constexpr double kSameNormal = 1e-6, kSameOffset_m = 1e-5;

bool one_equation(const Plane& a, const Plane& b) {
  return (a.normal - b.normal).norm() <= kSameNormal && std::abs(a.offset_m - b.offset_m) <= kSameOffset_m;
}

// By plane: the smallest id among the pieces of its geometric plane that the same region holds.
std::map<std::uint32_t, std::uint32_t> first_pieces(const std::map<std::uint32_t, TruePlane>& planes,
                                                    const RegionTable& table) {
  std::map<std::uint32_t, std::uint32_t> first;
  std::uint32_t region = 0;
  std::vector<std::uint32_t> held;  // by this region, one of each equation
  for (const auto& overlap : table.overlaps) {
    if (overlap.region != region) held.clear();
    region = overlap.region;
    const auto own = planes.find(overlap.plane);
    if (own == planes.end() || 2 * overlap.samples <= table.plane_size.at(overlap.plane)) continue;
    std::uint32_t& target = first[overlap.plane] = overlap.plane;
    for (const std::uint32_t other : held)
      if (one_equation(planes.at(other).in_world, own->second.in_world)) target = other;
    if (target == overlap.plane) held.push_back(overlap.plane);
  }
  return first;
}

}  // namespace

void join_coplanar_pieces(const std::map<std::uint32_t, TruePlane>& planes, JoinedScan& scan) {
  const auto first = first_pieces(planes, count_overlaps(scan, Planes::all));
  scan.plane_size.clear();
  for (std::size_t i = 0; i < scan.plane.size(); ++i) {
    if (scan.kind[i] != kPlanar || scan.plane[i] == 0) continue;
    if (const auto piece = first.find(scan.plane[i]); piece != first.end()) scan.plane[i] = piece->second;
    ++scan.plane_size[scan.plane[i]];
  }
}

}  // namespace score
