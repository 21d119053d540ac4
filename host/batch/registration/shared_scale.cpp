#include "batch/registration/shared_scale.hpp"

#include <algorithm>

#include "core/log.hpp"
#include "core/median.hpp"
#include "stages/registration/icp_step.hpp"

namespace hybrid::batch {
namespace {

constexpr double kAsMuch = 0.9;  // of its planar area must lie on faces as before

bool shows_no_scale(const ScanRegistration& one) {
  const auto& open = one.icp.degenerate;
  return !one.fixed && std::find(open.begin(), open.end(), stages::kFreeToScale) != open.end();
}

Vec3 middle_of(const stages::ScanEvidence& scan) {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const stages::PlaneTile& tile : scan.tiles) {
    sum += tile.area_m2 * tile.centroid;
    area += tile.area_m2;
  }
  return area > 0 ? Vec3(sum / area) : sum;
}

// Of this scale, its planes' middle where it was.
Pose scaled(const Pose& pose, const stages::ScanEvidence& scan, double scale) {
  Pose result = pose;
  result.scale = scale;
  result.translation += pose.rotation * Vec3((pose.scale - scale) * middle_of(scan));
  return result;
}

}  // namespace

void share_scale(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                 const std::vector<ScanProduct>& products, Registrations& registrations) {
  std::vector<double> shown;
  for (const auto& one : registrations)
    if (one && !shows_no_scale(*one)) shown.push_back(one->world_from_scan().scale);
  if (shown.empty()) return;
  const double scale = median(shown);
  StageOptions held = options;
  held.icp.free_scale = false;
  held.faces.solve = "never";
  for (std::size_t i = 0; i < registrations.size(); ++i) {
    if (!registrations[i] || !shows_no_scale(*registrations[i])) continue;
    ScanRegistration refined = *registrations[i];
    refined.start = scaled(refined.world_from_scan(), refined.evidence, scale);
    refine_to_model(queue, model, held, products[i], refined);
    if (refined.icp.overlap < kAsMuch * registrations[i]->icp.overlap) {
      warn(products[i],
           fmt::format(
               "its scale, which it does not show, is {:.6g} by its start and {:.6g} by other scans, with "
               "which it does not lie on the model: check its landmarks",
               registrations[i]->world_from_scan().scale, scale),
           *registrations[i]);
      continue;
    }
    log::info("scan {}: scale {:.6g} as other scans show it, {:.6g} before", products[i].id, scale,
              registrations[i]->world_from_scan().scale);
    refined.start = registrations[i]->start;
    refined.scale_of_others = true;
    registrations[i] = std::move(refined);
  }
}

}  // namespace hybrid::batch
