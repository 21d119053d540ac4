#include "score/measure/cylinders.hpp"

#include <algorithm>

namespace score {
namespace {

constexpr double kMargin_m = 0.005;

bool inside(const TrueSolid& solid, const Vec3& point) {
  return ((point - solid.low).array() > -kMargin_m).all() &&
         ((solid.high - point).array() > -kMargin_m).all();
}

double axis_off_m(const TrueSolid& solid, const std::array<Vec3, 2>& ends) {
  const Vec2 middle = 0.5 * (solid.low + solid.high).head<2>();
  return std::max((ends[0].head<2>() - middle).norm(), (ends[1].head<2>() - middle).norm());
}

bool is_of(const TrueSolid& solid, const std::array<Vec3, 2>& ends) {
  const Vec3 half = 0.5 * (ends[0] + ends[1]);
  return half.z() > solid.low.z() && half.z() < solid.high.z() && axis_off_m(solid, ends) <= kAxisOff_m;
}

}  // namespace

CylinderScore score_cylinders(const LabelledGrid& grid, const TrueSamples& samples,
                              const std::vector<TrueSolid>& solids, const Similarity& world_from_scan,
                              const std::vector<ResultCylinder>& cylinders, std::int64_t min_samples) {
  std::vector<std::int64_t> shown(solids.size());
  for (std::size_t i = 0; i < grid.source.size(); ++i) {
    if (grid.source[i] == kNoSource || samples.kind[grid.source[i]] != kCurved) continue;
    const Vec3 point = world_from_scan * Vec3(grid.point[i].cast<double>());
    for (std::size_t k = 0; k < solids.size(); ++k) shown[k] += inside(solids[k], point);
  }
  std::vector<std::array<Vec3, 2>> ends;
  for (const ResultCylinder& c : cylinders)
    ends.push_back({world_from_scan * c.foot, world_from_scan * Vec3(c.foot + c.length_m * c.axis)});
  CylinderScore score;
  std::vector<double> off;
  for (std::size_t k = 0; k < solids.size(); ++k) {
    if (solids[k].kind != "cylinder" || shown[k] < min_samples) continue;
    ++score.shown;
    const auto found =
        std::find_if(ends.begin(), ends.end(), [&](const auto& axis) { return is_of(solids[k], axis); });
    if (found == ends.end()) continue;
    ++score.found;
    off.push_back(1000 * axis_off_m(solids[k], *found));
  }
  for (const auto& axis : ends)
    score.invented += std::none_of(solids.begin(), solids.end(), [&](const TrueSolid& solid) {
      return (solid.kind == "cylinder" || solid.kind == "turned") && is_of(solid, axis);
    });
  std::sort(off.begin(), off.end());
  if (!off.empty()) score.axis_off_mm = off[off.size() / 2];
  return score;
}

}  // namespace score
