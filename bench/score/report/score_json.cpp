#include "score/report/score_json.hpp"

namespace score {
namespace {

using Json = nlohmann::ordered_json;

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json hoover_json(const HooverScore& score) {
  return {{"overlap", score.overlap},
          {"planes", score.planes},
          {"correct", score.correct},
          {"over_segmented", score.over_segmented},
          {"under_segmented", score.under_segmented},
          {"planes_under_segmented", score.planes_under_segmented},
          {"missed", score.missed},
          {"noise", score.noise},
          {"noise_of_few_samples", score.small_noise},
          {"mean_angle_deg", score.angles > 0 ? Json(score.mean_angle_deg) : Json()}};
}

Json distances_json(const BoundaryScore::Distances& distances) {
  return {{"borders", distances.borders},
          {"median_samples", distances.median},
          {"percentile_95_samples", distances.percentile_95},
          {"share_beyond_1_sample", distances.share_beyond_1}};
}

Json normals_json(const NormalScore& score) {
  return {{"planes", score.planes},
          {"within_3_bounds", score.within_3},
          {"median_of_bound", score.median},
          {"percentile_95_of_bound", score.percentile_95},
          {"largest_of_bound", score.largest},
          {"median_bound_deg", score.median_bound_deg}};
}

Json pose_json(const PoseScore& score) {
  return {{"status", score.accepted ? "accepted" : "abstained"},
          {"wrong", score.wrong},
          {"rotation_deg", score.rotation_deg},
          {"translation_mm", score.translation_mm},
          {"scale_error", score.scale_error}};
}

Json decimation_json(const DecimationScore& score) {
  return {{"input_samples", score.input_samples},
          {"discarded", score.discarded},
          {"discarded_share", share(score.discarded, score.input_samples)},
          {"discarded_without_polygon", score.without_polygon},
          {"largest_mm", score.largest_mm},
          {"percentile_99_9_mm", score.percentile_999_mm}};
}

Json view_json(const ViewScore& view) {
  const PictureQuality& quality = view.quality;
  const BleedingScore& sight = view.bleeding;
  return {{"name", view.name},
          {"against", view.against},
          {"share_seen", share(quality.compared, view.pixels)},
          {"psnr_db", quality.psnr_db},
          {"ssim", quality.ssim},
          {"sharpness", quality.sharpness},
          {"detail_agreement", quality.detail_agreement},
          {"gain", quality.gain},
          {"red_share", share(sight.red, sight.pixels)},
          {"red_though_seen_share", share(sight.red_though_seen, sight.pixels)},
          {"truly_unseen_share", share(sight.truly_unseen, sight.pixels)},
          {"bleeding_share", share(sight.bleeding, sight.painted)},
          {"bleeding_wrong_surface_share", share(sight.bleeding_elsewhere, sight.painted)},
          {"bleeding_at_centre_share", share(sight.bleeding_at_centre, sight.painted)}};
}

Json openings_json(const OpeningScore& score) {
  Json list = Json::array();
  for (const auto& one : score.openings)
    list.push_back({{"name", one.name},
                    {"face", one.face},
                    {"area_m2", one.area_m2},
                    {"open_share", or_null(one.open_share)},
                    {"reported_share", or_null(one.reported_share)},
                    {"rays", one.rays ? Json(*one.rays) : Json()},
                    {"spacing_m", or_null(one.spacing_m)},
                    {"border_m", or_null(one.border_m)},
                    {"border_bound_m", or_null(one.border_bound_m())}});
  const OpeningTally counted = tally(score);
  return {{"openings", list},
          {"of_500_rays",
           {{"openings", counted.openings},
            {"found", counted.found},
            {"border_within_bound", counted.within_bound}}},
          {"false_openings", score.false_openings ? Json(*score.false_openings) : Json()},
          {"wrongly_open_m2", or_null(score.wrongly_open_m2)},
          {"wrongly_reported_m2", or_null(score.wrongly_reported_m2)}};
}

Json common_fit_json(const CommonFit& fit) {
  return {{"scans", fit.scans},
          {"place_rms_mm", fit.place_rms_mm},
          {"rotation_rms_deg", fit.rotation_rms_deg},
          {"place_largest_mm", fit.place_largest_mm},
          {"rotation_largest_deg", fit.rotation_largest_deg},
          {"moved_mm", fit.moved_mm},
          {"moved_deg", fit.moved_deg}};
}

Json registration_json(const SceneScore& score) {
  int accepted = 0, abstained = 0, wrong = 0, none = 0;
  for (const ScanScore& scan : score.scans) {
    if (!scan.pose)
      ++none;
    else if (!scan.pose->accepted)
      ++abstained;
    else
      ++(scan.pose->wrong ? wrong : accepted);
  }
  return {{"right", accepted},
          {"wrong", wrong},
          {"abstained", abstained},
          {"no_result", none},
          {"in_the_frame_of", score.frame.empty() ? Json() : Json(score.frame)},
          {"after_common_fit", score.common_fit ? common_fit_json(*score.common_fit) : Json()}};
}

Json plane_figures_json(const PlaneScore& score) {
  const LabelScore& labels = score.labels;
  Json hoover = Json::array();
  for (const HooverScore& row : score.hoover) hoover.push_back(hoover_json(row));
  return {{"input_samples", score.input_samples},
          {"measured_samples", score.measured},
          {"planar_samples", labels.planar},
          {"planar_samples_right", labels.right},
          {"planar_samples_right_share", share(labels.right, labels.planar)},
          {"planes", labels.planes},
          {"planes_found", labels.found},
          {"planes_lost", labels.lost},
          {"curved_samples", labels.curved},
          {"curved_called_planar_share", share(labels.curved_called_planar, labels.curved)},
          {"mixed_samples", labels.mixed},
          {"mixed_called_planar_share", share(labels.mixed_called_planar, labels.mixed)},
          {"ghost_samples", labels.ghosts},
          {"ghosts_called_planar_share", share(labels.ghosts_called_planar, labels.ghosts)},
          {"boundary",
           {{"displaced", distances_json(score.boundary.displaced)},
            {"invented", distances_json(score.boundary.invented)},
            {"not_compared", score.boundary.not_compared}}},
          {"normals_from", score.normals_from},
          {"normals", score.normals ? normals_json(*score.normals) : Json()},
          {"hoover", hoover}};
}

Json cylinders_json(const CylinderScore& score) {
  return {{"shown", score.shown},
          {"found", score.found},
          {"invented", score.invented},
          {"axis_off_mm", score.axis_off_mm ? Json(*score.axis_off_mm) : Json()}};
}

}  // namespace

Json planes_json(const PlaneScore& score) {
  Json json = plane_figures_json(score);
  for (const PlaneRow& row : score.list)
    json["list"].push_back(
        {{"plane", row.plane},
         {"name", score.names.count(row.plane) > 0 ? Json(score.names.at(row.plane)) : Json()},
         {"samples", row.samples},
         {"region", row.region != 0 ? Json(row.region) : Json()},
         {"share_of_plane", row.share_of_plane()},
         {"share_of_region", row.share_of_region()},
         {"in_no_region", row.unlabelled},
         {"region_on_other_planes", row.strangers},
         {"region_curved", row.curved},
         {"region_mixed", row.mixed}});
  return json;
}

Json scene_json(const SceneScore& score, const ScoreOptions& options) {
  Json scans = Json::array(), views = Json::array();
  for (const ScanScore& scan : score.scans)
    scans.push_back({{"id", scan.id},
                     {"planes", scan.planes ? planes_json(*scan.planes) : Json()},
                     {"cylinders", scan.cylinders ? cylinders_json(*scan.cylinders) : Json()},
                     {"pose", scan.pose ? pose_json(*scan.pose) : Json()},
                     {"decimation", scan.decimation ? decimation_json(*scan.decimation) : Json()}});
  for (const ViewScore& view : score.views) views.push_back(view_json(view));
  return {{"truth", score.title},
          {"min_samples", options.min_samples},
          {"wrong_beyond",
           {{"deg", options.limits.deg}, {"mm", options.limits.mm}, {"scale", options.limits.scale}}},
          {"scans", scans},
          {"registration", registration_json(score)},
          {"views", views},
          {"openings", score.openings ? openings_json(*score.openings) : Json()},
          {"not_in_these_results", score.absent}};
}

}  // namespace score
