#include "batch/registration/turned_faces.hpp"

#include "core/suggest.hpp"
#include "stages/registration/face_sides.hpp"

namespace hybrid::batch {
namespace {

// Of a face's area, and at least so much, must be seen from behind.
constexpr double kLeastShare = 0.3, kLeast_m2 = 0.5;

}  // namespace

TurnedFaces faces_seen_from_behind(const stages::ProxyModel& model, const StageOptions& options,
                                   const std::vector<std::optional<ScanRegistration>>& registrations) {
  const PolygonModel& polygons = model.polygons();
  stages::FaceSides sides;
  double unit_m = 1;  // of a model without a known one: world metres of a scan's metre
  for (const auto& scan : registrations) {
    if (!scan) continue;
    unit_m = scan->world_from_scan().scale;
    sides += stages::face_sides(scan->evidence, model, scan->world_from_scan(),
                                options.alignment.tolerance_m * unit_m);
  }
  if (sides.back_m2.empty()) return {};
  std::vector<double> least_m2;
  for (const Face& face : polygons.faces)
    least_m2.push_back(std::max(kLeastShare * face_area_m2(polygons, face) / (unit_m * unit_m), kLeast_m2));
  const auto turned = stages::turned_faces(sides, least_m2);
  if (turned.empty()) return {};
  TurnedFaces found{stages::names_of_faces(polygons, turned), {}};
  found.warning = fmt::format(
      "model: {} of {} faces are seen by scans from behind ({}), so no scan is registered to them: corners "
      "must go counter-clockwise as scans see them; turn such faces round in the model",
      turned.size(), polygons.faces.size(), some_of(found.names));
  return found;
}

}  // namespace hybrid::batch
