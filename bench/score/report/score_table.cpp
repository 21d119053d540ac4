#include "score/report/score_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace score {
namespace {

using Row = std::vector<std::string>;

// The first column to the left, numbers to the right.
std::string aligned(const std::string& title, const std::vector<Row>& rows) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (widths.size() <= k) widths.push_back(0);
      widths[k] = std::max(widths[k], row[k].size());
    }
  std::string text = title + "\n";
  for (const Row& row : rows) {
    text += "  " + fmt::format("{:<{}}", row[0], widths[0]);
    for (std::size_t k = 1; k < row.size(); ++k) text += fmt::format("  {:>{}}", row[k], widths[k]);
    text += "\n";
  }
  return text + "\n";
}

std::string percent(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? fmt::format("{:.2f} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole))
                   : "-";
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100 * *share) : "-";
}

std::string square_metres(const std::optional<double>& area) {
  return area ? fmt::format("{:.3f}", *area) : "-";
}

std::string boundary(const BoundaryScore::Distances& distances) {
  return distances.borders > 0 ? fmt::format("{:.1f} / {:.1f} / {:.2f} %", distances.median,
                                             distances.percentile_95, 100 * distances.share_beyond_1)
                               : "-";
}

std::string hoover_table(const std::string& id, const PlaneScore& score) {
  std::vector<Row> rows = {{"overlap", "correct", "over", "under", "missed", "noise", "angle deg"}};
  for (const HooverScore& h : score.hoover)
    rows.push_back({fmt::format("{:.0f} %", 100 * h.overlap), fmt::format("{} of {}", h.correct, h.planes),
                    fmt::format("{}", h.over_segmented), fmt::format("{}", h.under_segmented),
                    fmt::format("{}", h.missed), fmt::format("{}", h.noise),
                    h.angles > 0 ? fmt::format("{:.4f}", h.mean_angle_deg) : "-"});
  std::string text = aligned(
      fmt::format("planes of {} as Hoover et al. count them (normals: {})", id, score.normals_from), rows);
  if (const auto& n = score.normals; n && n->planes > 0)
    text += fmt::format(
        "  normals of those correct at 80 %: {} of {} within 3 times their Cramer-Rao bound (error over "
        "bound: "
        "median {:.2f}, 95th percentile {:.1f}, largest {:.1f}; median bound {:.4f} deg)\n\n",
        n->within_3, n->planes, n->median, n->percentile_95, n->largest, n->median_bound_deg);
  return text;
}

std::string plane_list(const std::string& id, const PlaneScore& score) {
  if (score.list.empty()) return "";
  std::vector<Row> rows = {{"plane", "id", "samples", "region", "of plane", "of region", "in no region",
                            "region's on other planes", "curved", "mixed"}};
  for (const PlaneRow& row : score.list) {
    const auto named = score.names.find(row.plane);
    rows.push_back({named != score.names.end() ? named->second : "", fmt::format("{}", row.plane),
                    fmt::format("{}", row.samples), row.region != 0 ? fmt::format("{}", row.region) : "-",
                    percent(row.common, row.samples), percent(row.common, row.of_region),
                    fmt::format("{}", row.unlabelled), fmt::format("{}", row.strangers),
                    fmt::format("{}", row.curved), fmt::format("{}", row.mixed)});
  }
  return aligned("planes of " + id + " one by one, the worst first", rows);
}

std::string poses_table(const SceneScore& score) {
  std::vector<Row> rows = {{"scan", "status", "rotation deg", "place mm", "scale"}};
  for (const ScanScore& scan : score.scans) {
    if (!scan.pose) continue;
    const PoseScore& pose = *scan.pose;
    rows.push_back({scan.id,
                    pose.wrong      ? "WRONG"
                    : pose.accepted ? "accepted"
                                    : "abstained",
                    fmt::format("{:.5f}", pose.rotation_deg), fmt::format("{:.3f}", pose.translation_mm),
                    fmt::format("{:+.1e}", pose.scale_error)});
  }
  if (rows.size() == 1) return "";
  std::string text =
      aligned("registration" + (score.frame.empty() ? "" : ", with " + score.frame + " in its place"), rows);
  if (const auto& fit = score.common_fit)
    text += fmt::format(
        "  after one common rigid motion ({:.3f} mm, {:.5f} deg) of {} scans: rms {:.3f} mm, {:.5f} deg; "
        "largest {:.3f} mm, {:.5f} deg\n\n",
        fit->moved_mm, fit->moved_deg, fit->scans, fit->place_rms_mm, fit->rotation_rms_deg,
        fit->place_largest_mm, fit->rotation_largest_deg);
  return text;
}

std::string decimation_table(const std::vector<ScanScore>& scans) {
  std::vector<Row> rows = {{"scan", "discarded", "without polygon", "99.9th mm", "largest mm"}};
  for (const ScanScore& scan : scans) {
    if (!scan.decimation) continue;
    const DecimationScore& d = *scan.decimation;
    rows.push_back({scan.id, percent(d.discarded, d.input_samples), fmt::format("{}", d.without_polygon),
                    fmt::format("{:.2f}", d.percentile_999_mm), fmt::format("{:.2f}", d.largest_mm)});
  }
  return rows.size() > 1 ? aligned("decimation: discarded true points from their plane's polygon", rows) : "";
}

std::string cylinders_table(const std::vector<ScanScore>& scans) {
  std::vector<Row> rows = {{"scan", "columns shown", "found", "axis off mm", "invented"}};
  for (const ScanScore& scan : scans)
    if (const auto& c = scan.cylinders; c && (c->shown > 0 || c->invented > 0))
      rows.push_back({scan.id, fmt::format("{}", c->shown), fmt::format("{}", c->found),
                      c->axis_off_mm ? fmt::format("{:.1f}", *c->axis_off_mm) : "-",
                      fmt::format("{}", c->invented)});
  return rows.size() > 1 ? aligned("columns", rows) : "";
}

std::string views_table(const std::vector<ViewScore>& views) {
  if (views.empty()) return "";
  std::vector<Row> rows = {{"view", "against", "seen", "PSNR dB", "SSIM", "sharpness", "agreement", "red",
                            "truly unseen", "red though seen", "bleeding", "of wrong surface"}};
  for (const ViewScore& view : views) {
    const auto& [quality, sight] = std::tie(view.quality, view.bleeding);
    rows.push_back({view.name, view.against, percent(quality.compared, view.pixels),
                    fmt::format("{:.2f}", quality.psnr_db), fmt::format("{:.4f}", quality.ssim),
                    fmt::format("{:.3f}", quality.sharpness), fmt::format("{:.3f}", quality.detail_agreement),
                    percent(sight.red, sight.pixels), percent(sight.truly_unseen, sight.pixels),
                    percent(sight.red_though_seen, sight.pixels), percent(sight.bleeding, sight.painted),
                    percent(sight.bleeding_elsewhere, sight.painted)});
  }
  return aligned("views", rows);
}

std::string openings_table(const OpeningScore& score) {
  std::vector<Row> rows = {
      {"opening", "face", "m2", "left open", "reported", "rays", "spacing", "border off", "of at most"}};
  const auto mm = [](const std::optional<double>& m) {
    return m ? fmt::format("{:.0f} mm", 1000 * *m) : "-";
  };
  for (const auto& one : score.openings)
    rows.push_back({one.name, one.face, fmt::format("{:.2f}", one.area_m2), percent(one.open_share),
                    percent(one.reported_share), one.rays ? fmt::format("{}", *one.rays) : "-",
                    mm(one.spacing_m), mm(one.border_m), mm(one.border_bound_m())});
  rows.push_back({"elsewhere, m2", "", "", square_metres(score.wrongly_open_m2),
                  square_metres(score.wrongly_reported_m2)});
  const OpeningTally counted = tally(score);
  rows.push_back({fmt::format("of {} rays and more: {}", kCountedRays, counted.openings), "", "", "",
                  fmt::format("{} found", counted.found), "", "",
                  fmt::format("{} within", counted.within_bound)});
  return aligned("openings", rows);
}

}  // namespace

std::string planes_table(const std::vector<std::pair<std::string, const PlaneScore*>>& scans) {
  std::vector<Row> rows = {{"scan", "measured", "planar right", "planes found", "curved called planar",
                            "borders displaced", "borders invented"}};
  std::string hoover;
  for (const auto& [id, score] : scans) {
    const LabelScore& labels = score->labels;
    rows.push_back({id, fmt::format("{}", score->measured), percent(labels.right, labels.planar),
                    fmt::format("{} of {}", labels.found, labels.planes),
                    percent(labels.curved_called_planar, labels.curved), boundary(score->boundary.displaced),
                    boundary(score->boundary.invented)});
    hoover += hoover_table(id, *score) + plane_list(id, *score);
  }
  if (rows.size() == 1) return "";
  return aligned("planes (borders: median / 95th percentile, samples / share beyond one)", rows) + hoover;
}

std::string scene_table(const SceneScore& score) {
  std::vector<std::pair<std::string, const PlaneScore*>> labelled;
  for (const ScanScore& scan : score.scans)
    if (scan.planes) labelled.emplace_back(scan.id, &*scan.planes);
  std::string text = fmt::format("against the truth of {}\n\n", score.title);
  text += planes_table(labelled) + cylinders_table(score.scans) + poses_table(score) +
          decimation_table(score.scans) + views_table(score.views);
  if (score.openings) text += openings_table(*score.openings);
  if (!score.absent.empty()) {
    text += "not in these results:";
    for (const std::string& what : score.absent) text += (&what == &score.absent.front() ? " " : ", ") + what;
    text += "\n";
  }
  return text;
}

}  // namespace score
