#include "batch/planes_json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel_blocks.hpp"

namespace hybrid::batch {

nlohmann::ordered_json json_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

namespace {

using Json = nlohmann::ordered_json;

Json ring_json(const ContourRing& ring) {
  Json points = Json::array();
  for (const auto& point : ring.points) points.push_back(json_of(point));
  return {{"ring", ring.outer ? "outer" : "inner"}, {"points_m", points}};
}

Json intersections_json(const std::vector<stages::Intersection>& intersections) {
  Json list = Json::array();
  for (const auto& segment : intersections)
    list.push_back({{"planes", {segment.planes[0], segment.planes[1]}},
                    {"from_m", json_of(segment.from)},
                    {"to_m", json_of(segment.to)},
                    {"angle_deg", segment.angle_deg},
                    {"samples", segment.samples}});
  return list;
}

Json cylinders_json(const std::vector<Cylinder>& cylinders) {
  Json list = Json::array();
  for (const auto& cylinder : cylinders)
    list.push_back({{"id", cylinder.id},
                    {"seen_from", cylinder.inside ? "inside" : "outside"},
                    {"foot_m", json_of(cylinder.foot)},
                    {"axis", json_of(cylinder.axis)},
                    {"length_m", cylinder.length_m},
                    {"radius_m", cylinder.radius_m},
                    {"taper", cylinder.taper},
                    {"rms_m", cylinder.rms_m},
                    {"sigma_radius_m", cylinder.sigma_radius_m},
                    {"arc_deg", cylinder.arc_deg},
                    {"samples", cylinder.samples}});
  return list;
}

// Superclusters that no proxy face explains; empty before registration.
Json unexplained_json(const stages::ContourFaces& faces) {
  Json list = Json::array();
  for (const auto& fit : faces.fits)
    list.push_back({{"id", fit.supercluster},
                    {"unexplained_share", fit.unexplained_share},
                    {"shown_as", fit.polygon ? "polygon" : "samples"},
                    {"coverage", fit.coverage},
                    {"seen_through", fit.seen_through}});
  return list;
}

Json sample_file_json(const io::SampleFileSize& size) {
  const auto per = [](std::uint64_t bytes, std::int64_t samples) {
    return samples > 0 ? static_cast<double>(bytes) / static_cast<double>(samples) : 0.0;
  };
  return {{"samples", size.samples},
          {"bytes", size.bytes},
          {"bytes_per_sample", per(size.bytes, size.samples)},
          {"discarded", size.discarded},
          {"bytes_per_discarded_point", per(size.discarded_bytes, size.discarded)}};
}

}  // namespace

Json planes_json(const ScanProduct& product) {
  Json list = Json::array();
  for (const auto& supercluster : product.segmentation.superclusters) {
    Json contours = Json::array();
    for (const auto& ring : supercluster.contours) contours.push_back(ring_json(ring));
    list.push_back({{"id", supercluster.id},
                    {"normal", json_of(supercluster.plane.normal)},
                    {"offset_m", supercluster.plane.offset_m},
                    {"centroid_m", json_of(supercluster.centroid_m)},
                    {"rms_m", supercluster.rms_m},
                    {"area_m2", supercluster.area_m2},
                    {"squares", supercluster.squares},
                    {"samples", supercluster.samples},
                    {"contours", contours}});
  }
  return {{"scan", product.id},
          {"frame", "scan"},
          {"square", product.segmentation.square},
          {"sigma_m", product.sigma_m},
          {"waviness_m", product.segmentation.waviness_m},
          {"interleaved", product.segmentation.interleaved},
          {"superclusters", list},
          {"cylinders", cylinders_json(product.segmentation.cylinders)},
          {"intersections", intersections_json(product.intersections)}};
}

std::string intersections_obj(const ScanProduct& product) {
  std::string text = fmt::format("# lines in which planes of scan {} meet, scan frame, metres\n", product.id);
  for (const auto& segment : product.intersections)
    for (const Vec3* end : {&segment.from, &segment.to})
      text += fmt::format("v {:.5f} {:.5f} {:.5f}\n", end->x(), end->y(), end->z());
  for (std::size_t i = 0; i < product.intersections.size(); ++i)
    text += fmt::format("g planes-{}-{}\nl {} {}\n", product.intersections[i].planes[0],
                        product.intersections[i].planes[1], 2 * i + 1, 2 * i + 2);
  return text;
}

Json scan_figures(const ScanProduct& product) {
  const auto& image = product.image;
  const auto& fate = product.decimation.fate;
  const auto& classes = product.segmentation.square_class;
  const auto masked = [&](SampleMask mask) {
    return count_if_parallel(image.mask.size(), [&](std::size_t i) { return image.mask[i] == mask; });
  };
  const auto classed = [&](SquareClass kind) { return std::count(classes.begin(), classes.end(), kind); };
  const auto fated = [&](stages::SampleFate kind) {
    return count_if_parallel(fate.size(), [&](std::size_t i) { return fate[i] == kind; });
  };
  const auto strays = [&](stages::Stray kind) {
    return count_if_parallel(
        fate.size(), [&](std::size_t i) { return fate[i] > stages::kDiscarded && product.stray[i] == kind; });
  };
  const auto extra = static_cast<std::int64_t>(image.extra.size());
  const auto& clipped = product.extra_clipped;
  Json figures = {
      {"id", product.id},
      {"input_samples", product.input_samples},
      {"input_returns", product.input_returns},
      {"grid", {{"rows", image.rows}, {"cols", image.cols}, {"full_turn", image.wraps}}},
      {"nodes",
       {{"measured", masked(kMeasured)}, {"interpolated", masked(kInterpolated)}, {"empty", masked(kEmpty)}}},
      {"extra_samples", extra},
      {"duplicate_samples", image.duplicates.size()},
      {"sigma_m", product.sigma_m},
      {"waviness_m", product.segmentation.waviness_m},
      {"interleaved", product.segmentation.interleaved},
      {"square", product.segmentation.square},
      {"squares",
       {{"undersampled", classed(kUndersampled)},
        {"non_planar", classed(kNonPlanar)},
        {"planar_too_small", classed(kPlanarTooSmall)},
        {"in_superclusters", classed(kSuperclusterMember)}}},
      {"superclusters", product.segmentation.superclusters.size()},
      {"cylinders", product.segmentation.cylinders.size()},
      {"decimation",
       {{"measured", product.decimation.measured},
        {"discarded", product.decimation.discarded},
        {"discarded_share", product.decimation.discarded_share()},
        {"kept",
         {{"boundary", fated(stages::kBoundary)},
          {"non_planar_squares", fated(stages::kNonPlanarSquare)},
          {"small_planar_squares", fated(stages::kSmallPlanarSquare)},
          {"outliers", fated(stages::kOutlier)},
          {"undersampled_squares", fated(stages::kUndersampledSquare)},
          {"unexplained", fated(stages::kUnexplained)},
          {"extra", extra - std::count(clipped.begin(), clipped.end(), 1)}}},
        {"stray",
         {{"between_surfaces", strays(stages::kBetweenSurfaces)},
          {"isolated", strays(stages::kIsolated)},
          {"through_glass", strays(stages::kThroughGlass)}}}}},
      {"unexplained_planes", unexplained_json(product.contour_faces)},
      {"notes", product.notes}};
  if (product.sample_file) figures["lossless"] = sample_file_json(*product.sample_file);
  return figures;
}

}  // namespace hybrid::batch
