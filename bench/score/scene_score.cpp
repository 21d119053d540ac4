#include "score/scene_score.hpp"

#include <algorithm>

#include "score/error.hpp"
#include "score/measure/coplanar_pieces.hpp"
#include "score/measure/opening_rays.hpp"
#include "score/read/files.hpp"
#include "score/score_views.hpp"

namespace score {
namespace {

namespace fs = std::filesystem;

// Where a scan's results lie: DIR/scans/<id>, or DIR itself when it holds one scan's range.exr.
fs::path scan_folder(const fs::path& results, const TrueScan& scan, const TrueSamples& truth) {
  if (fs::exists(results / "scans" / scan.id)) return results / "scans" / scan.id;
  if (!fs::exists(results / "range.exr")) return {};
  const bool ours = range_disagreement(read_labelled_grid(results), truth) <= kSameScanM;
  return ours ? results : fs::path();
}

std::map<std::uint32_t, Plane> planes_in_scan(const SceneTruth& truth, const Similarity& world_from_scan) {
  std::map<std::uint32_t, Plane> planes;
  for (const auto& [id, plane] : truth.planes) {
    const auto& [normal, offset_m] = plane.in_world;
    planes[id] = {world_from_scan.rotation.transpose() * normal,
                  (offset_m - normal.dot(world_from_scan.translation)) / world_from_scan.scale};
  }
  return planes;
}

Normals normals_of(const std::map<std::uint32_t, Plane>& planes) {
  Normals normals;
  for (const auto& [id, plane] : planes) normals[id] = plane.normal;
  return normals;
}

const HooverScore& hoover_at(const PlaneScore& score, double overlap) {
  return *std::find_if(score.hoover.begin(), score.hoover.end(),
                       [&](const HooverScore& row) { return row.overlap == overlap; });
}

void score_labelled(const fs::path& folder, const SceneTruth& truth, const TrueScan& scan,
                    const TrueSamples& samples, const ScoreOptions& options, ScanScore& score) {
  const LabelledGrid grid = read_labelled_grid(folder);
  check_same_scan(grid, samples, (folder / "range.exr").string(), scan.image.string());
  JoinedScan joined = join(grid, samples, options.min_samples, (folder / "range.exr").string());
  join_coplanar_pieces(truth.planes, joined);
  const auto planes = read_result_planes(folder);
  Normals region_normals;
  if (planes)
    for (const auto& [id, plane] : *planes) region_normals[id] = plane.plane.normal;
  else
    region_normals = fit_region_normals(grid);
  const auto true_planes = planes_in_scan(truth, scan.world_from_scan);
  score.planes = score_planes(joined, region_normals, normals_of(true_planes), options);
  if (!grid.point.empty())
    score.planes->normals =
        score_normals(grid, samples, hoover_at(*score.planes, 0.80), region_normals, true_planes);
  for (const PlaneRow& row : score.planes->list)
    score.planes->names[row.plane] = truth.planes.at(row.plane).name;
  score.planes->normals_from = planes ? "planes.json" : "fit to the labelled samples";
  if (const auto cylinders = read_result_cylinders(folder); cylinders && !grid.point.empty())
    score.cylinders =
        score_cylinders(grid, samples, truth.solids, scan.world_from_scan, *cylinders, options.min_samples);
  if (!options.decimation) return;
  const auto kept = read_kept_points(folder);
  if (planes && kept && !grid.point.empty())
    score.decimation = score_decimation(grid, *planes, *kept, samples, (folder / "detail.ply").string());
}

// Without a model one scan's frame is that of all.
struct Frame {
  std::string scan;  // "": the truth's
  Similarity true_from_found;
};

Frame frame_of(const SceneTruth& truth, const fs::path& results) {
  for (const TrueScan& scan : truth.scans)
    if (const auto pose = read_result_pose(results / "scans" / scan.id); pose && pose->is_frame)
      return {scan.id, scan.world_from_scan * pose->world_from_scan.inverse()};
  return {};
}

ScanScore score_scan(const SceneTruth& truth, const TrueScan& scan, const Frame& frame,
                     const fs::path& results, const ScoreOptions& options, std::vector<PosePair>& accepted) {
  ScanScore score;
  score.id = scan.id;
  const TrueSamples samples = read_true_samples(scan);
  const fs::path folder = scan_folder(results, scan, samples);
  if (folder.empty()) return score;
  if (fs::exists(folder / "labels.exr")) score_labelled(folder, truth, scan, samples, options, score);
  if (auto pose = read_result_pose(folder)) {
    pose->world_from_scan = frame.true_from_found * pose->world_from_scan;
    score.pose = score_pose(*pose, scan.world_from_scan, options.limits);
    if (pose->accepted) accepted.push_back({pose->world_from_scan, scan.world_from_scan});
  }
  return score;
}

void check_folders(const SceneTruth& truth, const fs::path& results, const ScoreOptions& options) {
  if (!fs::is_directory(results))
    bad_input("{}: expected the folder that hybrid run --out wrote, found {}; run it first", results.string(),
              fs::exists(results) ? "a file" : "nothing");
  const auto named = [&](const TrueScan& scan) { return scan.id == options.scan; };
  if (!options.scan.empty() && std::none_of(truth.scans.begin(), truth.scans.end(), named))
    bad_input("--scan {}: {} has no scan of that name", options.scan, truth.file.string());
}

std::vector<std::string> list_absent(const SceneTruth& truth, const SceneScore& score) {
  std::vector<std::string> absent;
  for (const ScanScore& scan : score.scans) {
    if (!scan.planes) absent.push_back("labels of scan " + scan.id);
    if (!scan.pose) absent.push_back("pose of scan " + scan.id);
    if (scan.planes && !scan.decimation) absent.push_back("decimation of scan " + scan.id);
  }
  for (const TrueView& view : truth.views) {
    const auto named = [&](const ViewScore& found) { return found.name == view.camera.name; };
    if (std::none_of(score.views.begin(), score.views.end(), named))
      absent.push_back("view " + view.camera.name);
  }
  if (!truth.openings.empty() && !score.openings) absent.push_back("openings");
  return absent;
}

}  // namespace

PlaneScore score_planes(const JoinedScan& scan, const Normals& region_normals, const Normals& plane_normals,
                        const ScoreOptions& options) {
  PlaneScore score;
  score.input_samples = scan.input_samples;
  score.measured = scan.measured;
  score.labels = score_labels(scan);
  const RegionTable table = count_overlaps(scan, Planes::that_count);
  for (const double overlap : kHooverOverlaps)
    score.hoover.push_back(score_hoover(table, overlap, scan.min_samples, region_normals, plane_normals));
  score.boundary = score_boundaries(scan);
  if (options.list_planes) score.list = list_planes(scan);
  return score;
}

Normals fit_region_normals(const LabelledGrid& grid) {
  std::map<std::uint32_t, std::vector<Vec3>> points;
  for (std::size_t i = 0; i < grid.point.size(); ++i)
    if (grid.label[i] != 0) points[grid.label[i]].push_back(grid.point[i].cast<double>());
  Normals normals;
  for (const auto& [label, list] : points)
    if (list.size() >= 3) normals[label] = fit_plane(list).normal;
  return normals;
}

SceneScore score_scene(const fs::path& truth_file, const fs::path& results, const ScoreOptions& options) {
  const SceneTruth truth = read_scene_truth(truth_file);
  check_folders(truth, results, options);
  SceneScore score;
  score.title = truth.title;
  const Frame frame = frame_of(truth, results);
  score.frame = frame.scan;
  std::vector<PosePair> accepted;
  for (const TrueScan& scan : truth.scans)
    if (options.scan.empty() || scan.id == options.scan)
      score.scans.push_back(score_scan(truth, scan, frame, results, options, accepted));
  if (accepted.size() >= 2) score.common_fit = fit_in_common(accepted);
  score.views = score_views(truth, results);
  const EditedModel edited = read_edited_model(results);
  const fs::path proxy = truth.folder / "proxy.obj";
  if (edited.polygons || edited.reported)
    score.openings = score_openings(truth.openings, edited,
                                    fs::exists(proxy) ? read_obj_polygons(proxy) : std::vector<Ring>{});
  if (score.openings)
    for (const TrueScan& scan : truth.scans)
      if (fs::exists(results / "scans" / scan.id / "range.exr") &&
          fs::exists(results / "scans" / scan.id / "labels.exr"))
        count_opening_rays(read_labelled_grid(results / "scans" / scan.id), scan.world_from_scan,
                           truth.openings, *score.openings);
  const bool any_scan = std::any_of(score.scans.begin(), score.scans.end(),
                                    [](const ScanScore& scan) { return scan.planes || scan.pose; });
  if (!any_scan && score.views.empty() && !score.openings)
    bad_input(
        "{}: expected results of {}: scans/<id>/range.exr and labels.exr, scans/<id>/pose.json or "
        "views/<name>.exr "
        "with the names it knows, found none; run hybrid run SCENE.toml --out {} first",
        results.string(), truth_file.string(), results.string());
  score.absent = list_absent(truth, score);
  return score;
}

}  // namespace score
