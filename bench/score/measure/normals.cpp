#include "score/measure/normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace score {
namespace {

struct Region {
  std::vector<Eigen::Vector3f> points;
  std::vector<double> errors_m;  // measured less true range, absolute
};

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::map<std::uint32_t, Region> collect(const LabelledGrid& grid, const TrueSamples& truth,
                                        const HooverScore& hoover) {
  std::map<std::uint32_t, Region> regions;
  for (const auto& [plane, region] : hoover.region_of_plane) regions[region];
  for (std::size_t i = 0; i < grid.point.size(); ++i) {
    const auto found = regions.find(grid.label[i]);
    if (found == regions.end() || grid.source[i] == kNoSource) continue;
    found->second.points.push_back(grid.point[i]);
    const double error = std::abs(grid.range_m[i] - truth.range_m[grid.source[i]]);
    if (std::isfinite(error)) found->second.errors_m.push_back(error);
  }
  return regions;
}

}  // namespace

// Range along a ray u: r = d / (n . u). With n turned by a, b about the plane's two axes e1, e2 and d free:
// dr/da = -r/d (e1 . p), the same for b, dr/dd = r/d.
double direction_bound_rad(const Plane& plane, const std::vector<Eigen::Vector3f>& points) {
  const auto [first, second] = axes_across(plane.normal);
  Mat3 information = Mat3::Zero();
  for (const auto& p : points) {
    const Vec3 point = p.cast<double>();
    const double scale = point.norm() / plane.offset_m;
    const Vec3 slope(-scale * first.dot(point), -scale * second.dot(point), scale);
    information += slope * slope.transpose();
  }
  const Eigen::FullPivLU<Mat3> inverse(information);
  if (!inverse.isInvertible()) return std::numeric_limits<double>::infinity();
  return std::sqrt(inverse.inverse().topLeftCorner<2, 2>().trace());
}

NormalScore score_normals(const LabelledGrid& grid, const TrueSamples& truth, const HooverScore& hoover,
                          const Normals& region_normals,
                          const std::map<std::uint32_t, Plane>& planes_in_scan) {
  NormalScore score;
  auto regions = collect(grid, truth, hoover);
  std::vector<double> ratios, bounds_deg;
  for (const auto& [plane_id, region_id] : hoover.region_of_plane) {
    const auto plane = planes_in_scan.find(plane_id);
    const auto normal = region_normals.find(region_id);
    Region& region = regions[region_id];
    if (plane == planes_in_scan.end() || normal == region_normals.end() || region.errors_m.empty()) continue;
    const double noise_m = 1.4826 * median(region.errors_m);
    const double bound_deg =
        noise_m * direction_bound_rad(plane->second, region.points) * 180 / 3.14159265358979323846;
    if (!(bound_deg > 0) || !std::isfinite(bound_deg)) continue;
    const double angle = angle_between_deg(normal->second, plane->second.normal);
    ratios.push_back(std::min(angle, 180 - angle) / bound_deg);
    bounds_deg.push_back(bound_deg);
  }
  if (ratios.empty()) return score;
  score.planes = static_cast<int>(ratios.size());
  score.within_3 =
      static_cast<int>(std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 3; }));
  score.median_bound_deg = median(bounds_deg);
  score.median = median(ratios);
  std::sort(ratios.begin(), ratios.end());
  score.percentile_95 = ratios[(ratios.size() - 1) * 95 / 100];
  score.largest = ratios.back();
  return score;
}

}  // namespace score
