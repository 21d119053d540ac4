// Makes what every registration starts from: all-N.ply (measured samples, drawn evenly, scan order) and
// planar-N.ply (our planar samples as `hybrid register` chooses them) for N = 30, 100,000 and 1,000,000, and
// job.json with the true pose and a start that is off by 5 cm and 2 degrees.
#include <CLI/CLI.hpp>
#include <fstream>
#include <random>

#include "io/exr/range_exr.hpp"
#include "io/truth.hpp"
#include "shared/labels_exr.hpp"
#include "shared/peer_report.hpp"
#include "shared/points_ply.hpp"
#include "shared/pose_json.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::peers {
namespace {

PlaneSegmentation read_segmentation(const std::filesystem::path& folder, const RangeImage& image) {
  PlaneSegmentation segmentation;
  segmentation.sample_label = read_labels_exr(folder / "labels.exr", image.rows, image.cols);
  std::ifstream file(folder / "planes.json");
  const auto planes = nlohmann::json::parse(file);
  for (const auto& entry : planes.at("superclusters")) {
    Supercluster supercluster;
    supercluster.id = entry.at("id");
    for (int k = 0; k < 3; ++k)
      supercluster.plane.normal[k] = entry.at("normal")[static_cast<std::size_t>(k)];
    supercluster.plane.offset_m = entry.at("offset_m");
    segmentation.superclusters.push_back(supercluster);
  }
  return segmentation;
}

std::vector<PlyPoint> all_samples(const RangeImage& image, std::size_t count) {
  std::vector<PlyPoint> measured;
  for (std::size_t i = 0; i < image.count(); ++i)
    if (image.mask[i] == kMeasured) measured.push_back({image.x[i], image.y[i], image.z[i], 0, 0, 0, 1});
  std::vector<PlyPoint> drawn;
  std::mt19937 random(1);
  std::sample(measured.begin(), measured.end(), std::back_inserter(drawn), count, random);
  return drawn;
}

std::vector<PlyPoint> planar_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                     std::size_t count) {
  const auto chosen = stages::choose_planar_samples(image, segmentation, static_cast<int>(count), 1);
  std::vector<PlyPoint> points;
  for (std::size_t i = 0; i < chosen.points.size(); ++i) {
    const auto& [x, y, z, area] = chosen.points[i];
    const auto& [nx, ny, nz, unused] = chosen.normals[i];
    points.push_back({x, y, z, nx, ny, nz, area});
  }
  return points;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid;
  CLI::App app{"Makes the samples and the start pose of the registration jobs"};
  std::string scan, truth_file, out;
  app.add_option("--scan", scan, "DIR/scans/ID of hybrid planes")->required();
  app.add_option("--truth", truth_file, "truth.json of the scene")->required();
  app.add_option("--out", out, "folder")->required();
  CLI11_PARSE(app, argc, argv);
  return peers::report_of([&] {
    const std::filesystem::path folder(scan);
    const RangeImage image = io::read_range_exr(folder / "range.exr");
    const auto segmentation = peers::read_segmentation(folder, image);
    const auto truth = io::read_truth(truth_file);
    const auto known = std::find_if(truth.scans.begin(), truth.scans.end(),
                                    [&](const auto& s) { return s.id == folder.filename().string(); });
    if (known == truth.scans.end())
      throw std::runtime_error(truth_file + ": expected a scan named " + folder.filename().string());
    std::filesystem::create_directories(out);
    for (const std::size_t count : {30u, 100'000u, 1'000'000u}) {
      const std::filesystem::path base(out);
      peers::write_points_ply(base / ("all-" + std::to_string(count) + ".ply"),
                              peers::all_samples(image, count));
      peers::write_points_ply(base / ("planar-" + std::to_string(count) + ".ply"),
                              peers::planar_samples(image, segmentation, count));
    }
    const auto pose = row_major(known->world_from_scan);
    std::ofstream(std::filesystem::path(out) / "job.json") << nlohmann::json{
        {"start", peers::json_of(peers::disturbed(peers::matrix_of(pose)))},
        {"truth", pose}}.dump(1);
    return peers::Report{"hybrid", "samples and start pose", 0, {}, {}};
  });
}
