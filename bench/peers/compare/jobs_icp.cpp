#include <fmt/format.h>

#include <stdexcept>

#include "compare/process.hpp"
#include "compare/setup.hpp"
#include "shared/pose_json.hpp"

namespace hybrid::compare {
namespace {

using Path = std::filesystem::path;

struct IcpPeer {
  std::string name, program, variant, package;  // package empty: under HYBRID_PEERS_DIR
  bool ours = false, planar_only = false, large = true;
};

// Samples and start pose; `hybrid planes` has written what they come from (the planes job, or here).
void make_job(const Setup& setup, const Path& folder) {
  if (std::filesystem::exists(folder / "job.json")) return;
  const Path scene = setup.scenes / ("room-" + setup.sizes.front()), planes = setup.work / "ours-icp";
  const std::string scan = (scene / "scans" / (std::string(kScan) + ".ply")).string();
  const auto made = run_process(
      {(setup.bin / "hybrid").string(), "planes", scan, "--out", planes.string(), "--quiet", "--force"},
      setup.run_limit_s);
  if (const auto failure = failure_of(made); !failure.empty()) throw std::runtime_error(failure);
  const auto drawn =
      run_process({(setup.bin / "peers" / "icp_job").string(), "--scan", (planes / "scans" / kScan).string(),
                   "--truth", (scene / "truth.json").string(), "--out", folder.string()},
                  setup.run_limit_s);
  if (const auto failure = failure_of(drawn); !failure.empty()) throw std::runtime_error(failure);
}

Program program_of(const Setup& setup, const IcpPeer& peer, const std::string& source) {
  const bool external = peer.package.empty();
  const Path file = external ? setup.external / peer.program : setup.bin / "peers" / peer.program,
             folder = setup.work / "icp-job",
             proxy = setup.scenes / ("room-" + setup.sizes.front()) / "proxy.obj";
  Program program;
  program.name = peer.name;
  program.ours = peer.ours;
  program.large = peer.large;
  program.missing =
      external ? missing_external(setup, peer.program) : missing_peer(setup, peer.program, peer.package);
  program.run = [=](const Case& at) {
    make_job(setup, folder);
    const auto count = std::to_string(static_cast<long>(at.samples));
    std::vector<std::string> command = {file.string(),
                                        "--source",
                                        (folder / (source + "-" + count + ".ply")).string(),
                                        "--target",
                                        proxy.string(),
                                        "--start",
                                        (folder / "job.json").string(),
                                        "--threads",
                                        std::to_string(setup.threads)};
    if (!peer.variant.empty()) command.insert(command.end(), {"--variant", peer.variant});
    return run_peer(command, setup.run_limit_s);
  };
  program.score = [=](const Case&, Row& row) {
    const auto& report = row.runs.back().report;
    const auto error = peers::pose_error(peers::matrix_of(report.at("world_from_scan")),
                                         peers::read_pose(folder / "job.json", "truth"));
    row.score = {{"rotation_deg", error.angle_deg}, {"translation_mm", error.distance_mm}};
    row.quality = fmt::format("{:.4f} deg, {:.2f} mm", error.angle_deg, error.distance_mm);
    if (report.contains("iterations"))
      row.quality += fmt::format(", {} steps", report.at("iterations").get<int>());
  };
  return program;
}

}  // namespace

// The gates' influence on the error is seen at 100 k samples; at 1 M one of them tells the time.
std::vector<Job> icp_jobs(const Setup& setup) {
  std::vector<Case> cases = {{"30", 30, false}, {"100 k", 1e5, false}};
  if (!setup.quick) cases.push_back({"1 M", 1e6, false, true});
  const IcpPeer peers[] = {{"hybrid, plane step", "ours_icp", "plane", "OpenCL", true, true},
                           {"hybrid, the paper's step", "ours_icp", "paper", "OpenCL", true, false},
                           {"VTK ICP", "vtk_icp", "rigid", "VTK", false, false},
                           {"PCL plane ICP, gate 50 cm", "pcl_icp", "plane-50", "PCL", false, false, false},
                           {"PCL plane ICP, gate 15 cm", "pcl_icp", "plane-15", "PCL", false, false},
                           {"PCL plane ICP, gate 5 cm", "pcl_icp", "plane-5", "PCL", false, false, false},
                           {"PCL ICP, gate 50 cm", "pcl_icp", "point-50", "PCL", false, false},
                           {"Open3D plane ICP, gate 15 cm", "open3d_icp", "plane-15", "Open3D", false, false},
                           {"small_gicp", "small_gicp_icp", "", "", false, false}};
  std::vector<Job> jobs;
  for (const std::string source : {"planar", "all"}) {
    Job job{source == "planar" ? "ICP, our planar samples" : "ICP, all samples", cases, {}};
    job.larger_is_harder = false;  // 30 samples are harder to align than a million
    for (const auto& peer : peers)
      if (source == "planar" || !peer.planar_only) job.programs.push_back(program_of(setup, peer, source));
    jobs.push_back(job);
  }
  return jobs;
}

}  // namespace hybrid::compare
