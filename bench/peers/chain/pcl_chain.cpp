// What hybrid run does from scan to decimated points, as a user of PCL would chain it: an organised PCD is
// read, its planes found, samples of them registered to the proxy, what lies on planes discarded but for the
// contours, and all of it written. `--prepare` makes the PCD out of a range.exr, small holes filled.
#include <pcl/common/transforms.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/pcl_config.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "icp/pcl_registration.hpp"
#include "planes/pcl_cloud.hpp"
#include "planes/pcl_organised.hpp"
#include "shared/labels_exr.hpp"
#include "shared/peer_report.hpp"
#include "shared/pose_json.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace hybrid::peers {
namespace {

namespace fs = std::filesystem;

struct Request {
  std::string range, scan, proxy, start, out, variant = "gradient";
  bool prepare = false;
  double sigma_m = 0.002;
  std::size_t samples = 100'000, target_points = 1'000'000;
  int threads = 0;
};

void check(int result, const fs::path& file) {
  if (result < 0) throw std::runtime_error(file.string() + ": PCL could not read or write it");
}

std::size_t measured(const OrganisedCloud& cloud) {
  return static_cast<std::size_t>(
      std::count_if(cloud.begin(), cloud.end(), [](const auto& point) { return std::isfinite(point.x); }));
}

// Evenly through the labelled nodes.
NormalCloud::Ptr planar_samples(const OrganisedCloud& cloud, const std::vector<std::uint32_t>& labels,
                                std::size_t count) {
  const NormalCloud::Ptr samples(new NormalCloud);
  const auto planar = static_cast<std::size_t>(
      std::count_if(labels.begin(), labels.end(), [](std::uint32_t label) { return label > 0; }));
  const std::size_t step = std::max<std::size_t>(1, planar / count);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] > 0 && std::isfinite(cloud[i].x) && seen++ % step == 0) {
      pcl::PointNormal point;
      point.getVector3fMap() = cloud[i].getVector3fMap();
      samples->push_back(point);
    }
  return samples;
}

// What no plane explains, and the planes' contours.
OrganisedCloud retained(const OrganisedCloud& cloud, const OrganisedPlanes& planes) {
  OrganisedCloud kept;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (planes.labels[i] == 0 && std::isfinite(cloud[i].x)) kept.push_back(cloud[i]);
  for (const auto& contour : planes.contours) kept += contour;
  return kept;
}

OrganisedCloud moved(const OrganisedCloud& cloud, const Eigen::Matrix4d& pose) {
  OrganisedCloud world;
  pcl::transformPointCloud(cloud, world, Eigen::Matrix4f(pose.cast<float>()));
  return world;
}

// The whole scan in the world, as range.exr holds it; labels, planes, contours, what remains, the pose.
void write(const Request& request, const OrganisedCloud& cloud, const OrganisedPlanes& planes,
           const OrganisedCloud& kept, const Eigen::Matrix4d& pose) {
  const fs::path folder = fs::path(request.out) / "scans" / fs::path(request.range).parent_path().filename();
  write_result_folder(request.out, request.range, static_cast<int>(cloud.height),
                      static_cast<int>(cloud.width), planes.labels);
  check(pcl::io::savePCDFileBinary((folder / "registered.pcd").string(), moved(cloud, pose)), folder);
  check(pcl::io::savePLYFileBinary((folder / "detail.ply").string(), moved(kept, pose)), folder);
  auto list = nlohmann::json::array();
  for (std::size_t k = 0; k < planes.planes.size(); ++k) {
    const auto& p = planes.planes[k];
    auto contour = nlohmann::json::array();
    for (const auto& point : planes.contours[k]) contour.push_back({point.x, point.y, point.z});
    list.push_back({{"plane", {p[0], p[1], p[2], p[3]}}, {"contour", contour}});
  }
  std::ofstream(folder / "pcl_planes.json") << list.dump() << "\n";
  std::ofstream(folder / "pcl_pose.json")
      << nlohmann::json{{"world_from_scan", json_of(pose)}}.dump(1) << "\n";
}

Report prepare(const Request& request) {
  const auto scan = with_holes_filled(read_range_exr(request.range));
  check(pcl::io::savePCDFileBinary(request.scan, *organised_cloud(scan)), request.scan);
  return {"PCL " PCL_VERSION_PRETTY, "made the chain's input", 0, {}, {}};
}

Report run_chain(const Request& request) {
  Report report;
  report.package = "PCL " PCL_VERSION_PRETTY;
  const Stopwatch all;
  double before = 0;
  const auto part = [&](const char* name) {
    report.parts[name] = all.seconds() - before;
    before = all.seconds();
  };
  const OrganisedCloud::Ptr cloud(new OrganisedCloud);
  check(pcl::io::loadPCDFile(request.scan, *cloud), request.scan);
  const ProxyMesh proxy = read_proxy_obj(request.proxy);
  const Eigen::Matrix4d start = read_pose(request.start, "start");
  part("read");
  const std::size_t count = measured(*cloud);
  const auto planes = find_organised_planes(cloud, request.variant == "gradient", count, request.sigma_m);
  part("planes");
  const auto pose = register_by_pcl(planar_samples(*cloud, planes.labels, request.samples),
                                    proxy_cloud(proxy, request.target_points), start, true, {0.15, 0.05});
  part("register");
  const OrganisedCloud kept = retained(*cloud, planes);
  part("decimate");
  write(request, *cloud, planes, kept, pose);
  part("write");
  report.seconds = all.seconds();
  report.settings = "PCD, holes filled before; " + planes.settings + "; plane ICP, gates 15 and 5 cm, " +
                    std::to_string(request.samples / 1000) + " k samples, proxy as " +
                    std::to_string(request.target_points / 1000) + " k points";
  report.more = {{"samples", count},
                 {"threads", request.threads},
                 {"planes", planes.planes.size()},
                 {"discarded_share", 1 - static_cast<double>(kept.size()) / static_cast<double>(count)},
                 {"world_from_scan", json_of(pose)}};
  return report;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  CLI::App app{"PCL's chain from an organised PCD to decimated points; prints one JSON object"};
  Request request;
  app.add_option("--range", request.range, "DIR/scans/ID/range.exr of hybrid: names the scan")->required();
  app.add_option("--scan", request.scan, "organised PCD")->required();
  app.add_flag("--prepare", request.prepare, "make the PCD out of range.exr, and nothing else");
  app.add_option("--target", request.proxy, "proxy.obj");
  app.add_option("--start", request.start, "JSON file with the start pose as `start`");
  app.add_option("--out", request.out, "folder for scans/ID/");
  app.add_option("--variant", request.variant, "normals")->check(CLI::IsMember({"covariance", "gradient"}));
  app.add_option("--sigma", request.sigma_m, "range noise, metres")->check(CLI::PositiveNumber);
  app.add_option("--samples", request.samples, "of the planes, for the registration");
  app.add_option("--target-points", request.target_points, "that stand for the proxy");
  app.add_option("--threads", request.threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  return report_of([&] {
    if (request.threads == 0) request.threads = static_cast<int>(std::thread::hardware_concurrency());
#ifdef _OPENMP
    omp_set_num_threads(request.threads);
#endif
    return request.prepare ? prepare(request) : run_chain(request);
  });
}
