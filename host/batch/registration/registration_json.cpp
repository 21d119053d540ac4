#include "batch/registration/registration_json.hpp"

#include <cmath>

#include "batch/registration/automatic_json.hpp"
#include "batch/registration/face_json.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

Json share_json(const WallShare& share) {
  return {{"samples", share.samples}, {"within_5cm", share.within_5cm}, {"within_10cm", share.within_10cm}};
}

Json landmark_json(const stages::LandmarkFit& fit) {
  Json json = {
      {"rms_m", fit.rms_m}, {"residual_m", fit.residual_m}, {"leave_one_out_m", fit.leave_one_out_m}};
  if (fit.left_out) json["left_out"] = *fit.left_out + 1;  // as messages count them
  return json;
}

Json on_scans_json(const OnScans& on) {
  const auto& icp = on.icp.icp;
  Json others = Json::array();
  for (std::size_t k = 0; k < on.others.size(); ++k) {
    const auto& other = on.icp.others[k];
    if (other.on_m2 > 0 || other.through_m2 > 0)
      others.push_back({{"scan", on.others[k]},
                        {"overlap", other.overlap},
                        {"rms_m", other.rms_m},
                        {"on_m2", other.on_m2},
                        {"seen_through_m2", other.through_m2}});
  }
  Json json = {{"rms_m", icp.rms_m},
               {"overlap", icp.overlap},
               {"seen_through", on.icp.seen_through},
               {"degenerate", icp.degenerate},
               {"scans", others}};
  if (!on.start.empty()) json["start"] = on.start;
  return json;
}

Json slide_json(const OnSlide& slide) {
  const stages::SlideOnScans& found = slide.found;
  Json scans = Json::array();
  for (std::size_t k = 0; k < slide.others.size(); ++k)
    if (found.on_other_m2[k] > 0)
      scans.push_back({{"scan", slide.others[k]}, {"on_m2", found.on_other_m2[k]}});
  const Vec3& d = found.direction;
  Json json = {{"direction", {d.x(), d.y(), d.z()}},
               {"status", found.accepted ? "accepted" : "abstained"},
               {"shift_m", found.shift_m},
               {"sigma_m", found.sigma_m},
               {"on_m2", found.on_m2},
               {"seen_through", found.seen_through()},
               {"elsewhere", found.elsewhere},
               {"scans", scans}};
  if (!found.accepted) json["reason"] = found.reason;
  return json;
}

Json residuals_json(const RegisteredNodes& found, const ResidualHistogram& residuals) {
  Json json = {{"to", found.to}};
  json.update(histogram_json(residuals));
  return json;
}

Json island_json(const Island& island) {
  Json json = {{"frame", island.frame},
               {"frame_from_scan", row_major(island.frame_from_scan)},
               {"others", island.others}};
  if (island.on_scans) json["on_scans"] = on_scans_json(*island.on_scans);
  return json;
}

Json recorded_json(const ByRecorded& recorded) {
  Json json = {{"beside", recorded.by}};
  if (const auto& word = recorded.word)
    json["kept"] = {{"scans_that_agree", word->agree},
                    {"scans_that_differ", word->differ},
                    {"farthest_m", word->farthest_m},
                    {"farthest_deg", word->farthest_rad * 180 / M_PI}};
  return json;
}

// What pose.json and summary.json say alike of a scan without a pose.
Json abstained_json(const ScanRegistration& registration) {
  Json json = {{"how", registration.how}, {"status", "abstained"}};
  if (!registration.warnings.empty()) json["warnings"] = registration.warnings;
  if (registration.automatic) json.update(automatic_json(*registration.automatic));
  json["reason"] = reason_of(registration);
  for (const PossiblePlace& place : registration.places)
    json["places"].push_back({{"how", place.words}, {"world_from_scan", row_major(place.world_from_scan)}});
  if (registration.island) json["island"] = island_json(*registration.island);
  if (registration.on_scans)
    json["refused"] = {{"world_from_scan", row_major(registration.on_scans->icp.icp.world_from_scan)},
                       {"on_scans", on_scans_json(*registration.on_scans)}};
  if (registration.planar_area)
    json["refused"] = {{"world_from_scan", row_major(registration.world_from_scan())},
                       {"rms_m", registration.icp.rms_m},
                       {"overlap", registration.icp.overlap},
                       {"planar_area", planar_area_json(*registration.planar_area)}};
  return json;
}

}  // namespace

Json pose_json(const ScanProduct& product, const ScanRegistration& registration) {
  if (registration.abstained) {
    Json json = {{"scan", product.id}, {"world_from_scan", nullptr}};
    json.update(abstained_json(registration));
    if (registration.landmarks) json["landmarks"] = landmark_json(*registration.landmarks);
    if (registration.neighbour) json["neighbour"] = automatic_json(*registration.neighbour);
    if (const auto found = residual_nodes(product, registration))
      json["residuals"] = residuals_json(*found, registration.residuals);
    return json;
  }
  const auto& icp = registration.icp;
  Json json = {{"scan", product.id},
               {"world_from_scan", row_major(registration.world_from_scan())},
               {"scale", registration.world_from_scan().scale},
               {"how", registration.how},
               {"status", "accepted"},
               {"start_world_from_scan", row_major(registration.start)}};
  if (registration.scale_of_others) json["scale_of_others"] = true;
  if (!registration.carried_by.empty()) json["aligned_to"] = registration.carried_by;
  if (registration.recorded) json["recorded"] = recorded_json(*registration.recorded);
  if (registration.neighbour) {
    json["neighbour"] = automatic_json(*registration.neighbour);
    json["held_by_model"] = registration.held_by_model && registration.faces.has_value();
  }
  if (!registration.fixed && !registration.faces) json["covariance"] = icp.covariance;
  if (registration.on_scans) json["on_scans"] = on_scans_json(*registration.on_scans);
  if (!registration.fixed && registration.faces) {
    json["rms_m"] = icp.rms_m;
    json["overlap"] = icp.overlap;
    json["iterations"] = icp.iterations;
    json["converged"] = icp.converged;
    json["covariance"] = icp.covariance;
    json["degenerate"] = icp.degenerate;
  }
  if (registration.slide) json["slide"] = slide_json(*registration.slide);
  if (registration.planar_area) json["planar_area"] = planar_area_json(*registration.planar_area);
  if (!registration.warnings.empty()) json["warnings"] = registration.warnings;
  if (registration.landmarks) json["landmarks"] = landmark_json(*registration.landmarks);
  if (registration.automatic) json["automatic"] = automatic_json(*registration.automatic);
  if (registration.faces)
    json["faces"] = face_offsets_json(*registration.faces, registration.solved_with_faces);
  if (const auto found = residual_nodes(product, registration))
    json["residuals"] = residuals_json(*found, registration.residuals);
  return json;
}

Json registration_figures(const ScanRegistration& registration) {
  if (registration.abstained) {
    Json json = abstained_json(registration);
    if (!registration.neighbour_reason.empty()) json["neighbours"] = registration.neighbour_reason;
    return json;
  }
  const auto moved = difference(registration.start, registration.world_from_scan());
  Json json = {{"how", registration.how},
               {"status", "accepted"},
               {"moved_by_icp", {{"deg", moved.angle_rad * 180 / M_PI}, {"m", moved.distance_m}}}};
  if (!registration.carried_by.empty()) json["aligned_to"] = registration.carried_by;
  if (registration.recorded) json["recorded"] = recorded_json(*registration.recorded);
  if (registration.faces) {
    json["wall_before_icp"] = share_json(registration.wall_before);
    json["wall_after_icp"] = share_json(registration.wall_after);
  }
  if (registration.on_scans) {
    json["icp_rms_m"] = registration.on_scans->icp.icp.rms_m;
    json["overlap"] = registration.on_scans->icp.icp.overlap;
    json["seen_through"] = registration.on_scans->icp.seen_through;
    json["degenerate"] = registration.on_scans->icp.icp.degenerate;
    if (!registration.on_scans->start.empty()) {
      json["icp_iterations"] = registration.icp.iterations;
      json["icp_converged"] = registration.icp.converged;
    }
  }
  if (registration.automatic) json["automatic"] = automatic_json(*registration.automatic);
  if (!registration.warnings.empty()) json["warnings"] = registration.warnings;
  if (registration.landmarks) json["landmark_rms_m"] = registration.landmarks->rms_m;
  if (!registration.fixed && registration.faces) {
    json["icp_rms_m"] = registration.icp.rms_m;
    json["icp_iterations"] = registration.icp.iterations;
    json["icp_converged"] = registration.icp.converged;
    json["overlap"] = registration.icp.overlap;
    json["degenerate"] = registration.icp.degenerate;
  }
  if (registration.slide) json["slide"] = slide_json(*registration.slide);
  if (registration.faces)
    json["faces"] = face_offsets_json(*registration.faces, registration.solved_with_faces);
  if (!registration.written.is_null()) json["written"] = registration.written;
  return json;
}

}  // namespace hybrid::batch
