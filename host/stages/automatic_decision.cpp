#include "stages/automatic_decision.hpp"

#include <algorithm>
#include <map>

namespace hybrid::stages {
namespace {

double contradiction(Sight sight) {
  switch (sight) {
    case Sight::through:
      return 1;
    case Sight::in_front:
    case Sight::behind:
      return 0.5;
    case Sight::nothing:
      return 0.05;
    default:
      return 0;
  }
}

}  // namespace

Comparison compare(const std::vector<SightRay>& rays, const std::vector<SightLine>& pose,
                   const std::vector<SightLine>& other) {
  Comparison result;
  std::map<std::uint32_t, double> by_plane;
  double total = 0, against = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    total += rays[k].area_m2;
    if (pose[k].sight == Sight::supported)
      by_plane[rays[k].plane] += rays[k].area_m2 * contradiction(other[k].sight);
    if (other[k].sight == Sight::supported) {
      const double cost = rays[k].area_m2 * contradiction(pose[k].sight);
      against += cost;
      by_plane[rays[k].plane] += 0;
    }
  }
  if (!(total > 0)) return result;
  double largest = 0;
  for (const auto& [plane, area] : by_plane) {
    result.for_it += area / total;
    largest = std::max(largest, area / total);
  }
  result.against_it = against / total;
  result.without_largest = result.for_it - largest;
  return result;
}

double strength(const Comparison& c, const MarginRule& rule) {
  return std::min({c.gap() / rule.least_gap, c.consistency() / rule.least_consistency,
                   (c.without_largest - c.against_it) / rule.least_without_largest});
}

}  // namespace hybrid::stages
