#include <algorithm>
#include <cmath>

#include "stages/registration/automatic_checks.hpp"
#include "stages/registration/automatic_search.hpp"

namespace hybrid::stages {
namespace {

// So much more of the planar area must lie on faces of the corrected model.
constexpr double kMuchMore = 0.15, kMost = 0.5;

PolygonModel inside_out(PolygonModel model) {
  for (Face& face : model.faces) {
    std::reverse(face.outer.begin(), face.outer.end());
    for (auto& hole : face.holes) std::reverse(hole.begin(), hole.end());
  }
  return model;
}

PolygonModel mirrored(const PolygonModel& model) {
  PolygonModel other = inside_out(model);
  for (Vec3& vertex : other.vertices) vertex.x() = -vertex.x();
  return other;
}

double best_support(device::Queue& queue, const ScanEvidence& scan, const ProxyModel& model,
                    const AutomaticOptions& options) {
  SightCaster caster(queue, model);
  const Search search = search_poses(caster, scan, model.shapes(), 1, options);
  return search.finalists.empty() ? 0 : search.finalists[0].shares.supported;
}

}  // namespace

std::string diagnose_model(device::Queue& queue, const ScanEvidence& scan, const PolygonModel& model,
                           double supported, const AutomaticOptions& options) {
  const double enough = std::max(supported + kMuchMore, kMost);
  if (supported + kMuchMore > 1) return "";
  if (const double share = best_support(queue, scan, inside_out(model), options); share >= enough)
    return fmt::format(
        "the model is inside out or mirrored: with its faces turned round {:.0f} % of the scan's planar area "
        "lie on faces, as it is {:.0f} %; faces must be counter-clockwise seen from where the scanner stands",
        100 * share, 100 * supported);
  if (const double share = best_support(queue, scan, mirrored(model), options); share >= enough)
    return fmt::format(
        "the model is mirrored: its mirror image holds {:.0f} % of the scan's planar area, the model as it "
        "is "
        "{:.0f} %; negate one axis of its vertices",
        100 * share, 100 * supported);
  return "";
}

std::string diagnose_pose(device::Queue& queue, const ScanEvidence& scan, const ProxyModel& model,
                          double scale, double supported, const AutomaticOptions& options) {
  if (std::string words = odd_size(scan, model.shapes(), scale, kSizeRatio); !words.empty()) return words;
  if (std::abs(scale - 1) > kRounded || !unsuitable(scan, model.shapes(), options).empty()) return "";
  const double best = best_support(queue, scan, model, options);
  if (std::string words = diagnose_model(queue, scan, model.polygons(), std::max(best, supported), options);
      !words.empty())
    return words;
  if (best < std::max(supported + kMuchMore, kMost)) return "";
  return fmt::format(
      "another pose would lay {:.0f} % of the planar area on faces: the start is wrong, or the model is of "
      "another place",
      100 * best);
}

}  // namespace hybrid::stages
