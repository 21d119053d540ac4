#include "score/benchmark_score.hpp"

#include <algorithm>

#include "score/error.hpp"
#include "score/read/labelled_pcd.hpp"
#include "score/read/segcomp.hpp"
#include "score/report/score_json.hpp"
#include "score/report/score_table.hpp"

namespace score {
namespace {

namespace fs = std::filesystem;

// The result's labels over the benchmark's own image, and the regions' directions.
struct Labelled {
  LabelledGrid grid;
  Normals normals;
  std::string normals_from;
};

fs::path only_scan(const fs::path& results) {
  if (fs::exists(results / "range.exr")) return results;
  std::vector<fs::path> scans;
  if (fs::is_directory(results / "scans"))
    for (const auto& entry : fs::directory_iterator(results / "scans")) scans.push_back(entry.path());
  if (scans.size() != 1)
    bad_input(
        "{}: expected range.exr and labels.exr, here or in its only scan, found {} scans; name the scan's "
        "folder",
        results.string(), scans.size());
  return scans.front();
}

Labelled read_folder(const fs::path& results) {
  const fs::path folder = only_scan(results);
  Labelled labelled{read_labelled_grid(folder), {}, ""};
  if (const auto planes = read_result_planes(folder)) {
    for (const auto& [id, plane] : *planes) labelled.normals[id] = plane.plane.normal;
    labelled.normals_from = "planes.json";
  } else {
    labelled.normals = fit_region_normals(labelled.grid);
    labelled.normals_from = "fit to the labelled samples";
  }
  return labelled;
}

Labelled read_machine_segmentation(const fs::path& file) {
  const RasterLabels labels = read_rasterfile(file);
  Labelled labelled;
  labelled.grid.rows = labels.height;
  labelled.grid.cols = labels.width;
  labelled.grid.label = labels.label;
  for (std::size_t i = 0; i < labels.label.size(); ++i)
    labelled.grid.source.push_back(static_cast<std::uint32_t>(i));
  const fs::path normals = fs::path(file).replace_extension(".ms-nor");
  labelled.normals_from = "none";
  if (fs::exists(normals)) {
    labelled.normals = read_region_normals(normals);
    labelled.normals_from = normals.filename().string();
  }
  return labelled;
}

TrueSamples samples_of(std::vector<std::uint32_t> labels) {
  TrueSamples samples;
  for (const std::uint32_t label : labels) samples.kind.push_back(label != 0 ? kPlanar : kMixed);
  samples.plane = std::move(labels);
  return samples;
}

Normals fit_plane_normals(const LabelledPcd& cloud) {
  std::map<std::uint32_t, std::vector<Vec3>> points;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.label[i] != 0 && cloud.points[i].allFinite()) points[cloud.label[i]].push_back(cloud.points[i]);
  Normals normals;
  for (const auto& [label, list] : points)
    if (list.size() >= 3) normals[label] = fit_plane(list).normal;
  return normals;
}

// The stated angle between two true regions against the angle between the regions found for them, at 51 %
// overlap.
void compare_angles(const fs::path& file, const Normals& normals, BenchmarkScore& score) {
  if (!fs::exists(file) || normals.empty()) return;
  const auto& region_of = score.planes.hoover.front().region_of_plane;
  const auto folded = [](double deg) { return deg > 90 ? 180 - deg : deg; };
  double sum = 0;
  for (const RegionAngle& truth : read_region_angles(file)) {
    const auto a = region_of.find(truth.a), b = region_of.find(truth.b);
    if (a == region_of.end() || b == region_of.end()) continue;
    const auto normal_a = normals.find(a->second), normal_b = normals.find(b->second);
    if (normal_a == normals.end() || normal_b == normals.end()) continue;
    ++score.angles_compared;
    sum += std::abs(folded(truth.deg) - folded(angle_between_deg(normal_a->second, normal_b->second)));
  }
  if (score.angles_compared > 0) score.mean_angle_error_deg = sum / score.angles_compared;
}

}  // namespace

bool is_benchmark(const fs::path& truth) {
  return truth.extension() == ".pcd" || truth.extension() == ".gt-seg";
}

BenchmarkScore score_benchmark(const fs::path& truth, const fs::path& results, const ScoreOptions& options) {
  BenchmarkScore score;
  score.name = truth.filename().string();
  const bool segcomp = truth.extension() == ".gt-seg";
  TrueSamples samples;
  Normals plane_normals;
  if (segcomp) {
    samples = samples_of(read_rasterfile(truth).label);
  } else {
    const LabelledPcd cloud = read_labelled_pcd(truth);
    plane_normals = fit_plane_normals(cloud);
    samples = samples_of(cloud.label);
    for (const Vec3& point : cloud.points) samples.range_m.push_back(static_cast<float>(point.norm()));
  }
  if (!fs::exists(results))
    bad_input("{}: expected the results for {}, found nothing; run hybrid planes on the image first",
              results.string(), truth.string());
  if (!segcomp && !fs::is_directory(results))
    bad_input("{}: expected a folder with range.exr and labels.exr, found a file", results.string());
  const Labelled labelled =
      fs::is_directory(results) ? read_folder(results) : read_machine_segmentation(results);
  const JoinedScan joined = join(labelled.grid, samples, options.min_samples, results.string());
  if (!segcomp) check_same_scan(labelled.grid, samples, results.string(), truth.string());
  score.planes = score_planes(joined, labelled.normals, plane_normals, options);
  score.planes.normals_from = labelled.normals_from;
  if (segcomp) compare_angles(fs::path(truth).replace_extension(".gt-ang"), labelled.normals, score);
  return score;
}

nlohmann::ordered_json benchmark_json(const BenchmarkScore& score) {
  nlohmann::ordered_json json = {{"truth", score.name}, {"planes", planes_json(score.planes)}};
  if (score.angles_compared > 0)
    json["region_angles"] = {{"compared", score.angles_compared},
                             {"mean_error_deg", score.mean_angle_error_deg}};
  return json;
}

std::string benchmark_table(const BenchmarkScore& score) {
  std::string text = planes_table({{score.name, &score.planes}});
  if (score.angles_compared > 0)
    text += fmt::format("angles between neighbouring regions: {} compared, mean error {:.3f} deg\n",
                        score.angles_compared, score.mean_angle_error_deg);
  return text;
}

}  // namespace score
