#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "compare/process.hpp"
#include "compare/setup.hpp"
#include "compare/statistics.hpp"

namespace hybrid::compare {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

std::string size_of(const Case& at) {
  return at.size.substr(0, at.size.find(' '));
}
Path scene(const Setup& setup, const Case& at) {
  return setup.scenes / ("room-" + size_of(at));
}
Path ours_folder(const Setup& setup, const Case& at) {
  return setup.work / "ours" / size_of(at);
}
Path ours_range(const Setup& setup, const Case& at) {
  return ours_folder(setup, at) / "scans" / kScan / "range.exr";
}

// `hybrid planes` as users run it. Seconds: the stages from the range image in memory to its labels; the
// others are in the report's parts.
Run run_ours(const Setup& setup, const Case& at) {
  const Path out = ours_folder(setup, at);
  const std::vector<std::string> command = {
      (setup.bin / "hybrid").string(),
      "planes",
      (scene(setup, at) / "scans" / (std::string(kScan) + ".ply")).string(),
      "--out",
      out.string(),
      "--quiet",
      "--force",
      "--threads",
      std::to_string(setup.threads)};
  const Finished finished = run_process(command, 2 * setup.run_limit_s);
  if (const auto failure = failure_of(finished); !failure.empty()) throw std::runtime_error(failure);
  const Json timing = read_json(out / "timing.json"), summary = read_json(out / "summary.json");
  Run run;
  run.wall_s = finished.wall_s;
  run.cpu_s = finished.cpu_s;
  run.peak_mb = finished.peak_mb;
  for (const char* stage : {"square planes", "superclusters"})
    run.seconds += timing.at("seconds_by_stage").at(stage).get<double>();
  const Json& scan = summary.at("scans").at(0);
  const int square = scan.at("square");
  double kernels = 0;
  for (const auto& [name, row] : timing.at("kernels").items()) kernels += row.at("seconds").get<double>();
  run.report = {{"package", "hybrid " + summary.at("program").at("version").get<std::string>()},
                {"samples", scan.at("nodes").at("measured")},
                {"square", square},
                {"parts", timing.at("seconds_by_stage")},
                {"kernels", timing.at("kernels")},
                {"settings", fmt::format("{} x {} squares; kernels {} s, whole process {} s", square, square,
                                         three_digits(kernels), three_digits(finished.wall_s))}};
  return run;
}

Run run_planes_peer(const Setup& setup, const Case& at, const Path& program, const std::string& variant,
                    const std::vector<std::string>& more) {
  if (!std::filesystem::exists(ours_range(setup, at)))
    throw NoInput("no range image: hybrid planes made none");
  const Path out = setup.work / (program.filename().string() + "-" + variant) / size_of(at);
  std::vector<std::string> command = {program.string(), "--range",   ours_range(setup, at).string(), "--out",
                                      out.string(),     "--threads", std::to_string(setup.threads)};
  if (!variant.empty()) command.insert(command.end(), {"--variant", variant});
  command.insert(command.end(), more.begin(), more.end());
  Run run = run_peer(command, setup.run_limit_s);
  run.report["out"] = out.string();
  return run;
}

std::vector<Case> cases_of(const Setup& setup) {
  std::vector<Case> cases;
  const auto add = [&](const std::string& size, bool probe) {
    const double samples = 1e6 * std::stod(size);
    const auto missing = setup.no_scan.find(size);
    cases.push_back({size + " MP", samples, probe, samples > 1e6 * kLarge_mp,
                     missing == setup.no_scan.end() ? "" : missing->second});
  };
  add(setup.probe_size, true);
  for (const auto& size : setup.sizes) add(size, false);
  return cases;
}

struct PlanesPeer {
  std::string name, program, variant, package;
  bool slow = false, large = false;
};

Program program_of(const Setup& setup, const PlanesPeer& peer, const std::vector<std::string>& more) {
  const bool external = peer.package.empty();
  const Path file = external ? setup.external / peer.program : setup.bin / "peers" / peer.program;
  Program program;
  program.name = peer.name;
  program.slow = peer.slow;
  program.large = peer.large;
  program.missing =
      external ? missing_external(setup, peer.program) : missing_peer(setup, peer.program, peer.package);
  program.run = [=](const Case& at) { return run_planes_peer(setup, at, file, peer.variant, more); };
  program.score = [=](const Case& at, Row& row) {
    score_labels(setup, scene(setup, at), kScan, row.runs.back().report.at("out").get<std::string>(), row);
  };
  return program;
}

// The same program without its growing of planes.
Program squares_of(const Setup& setup, const PlanesPeer& peer) {
  Program program = program_of(setup, peer, {"--square", "5", "--squares-only"});
  program.score = {};
  return program;
}

}  // namespace

Job planes_job(const Setup& setup) {
  Job job{"planes", cases_of(setup), {}};
  Program ours;
  ours.name = "hybrid planes";
  ours.ours = ours.large = true;
  ours.run = [=](const Case& at) { return run_ours(setup, at); };
  ours.score = [=](const Case& at, Row& row) {
    score_labels(setup, scene(setup, at), kScan, ours_folder(setup, at), row);
  };
  job.programs.push_back(ours);
  const PlanesPeer peers[] = {
      {"C++/OpenMP RANSAC per square", "twin_planes", "32", "OpenMP", false, true},
      {"PCL SACSegmentation per square", "pcl_square_planes", "32", "PCL"},
      {"PCL organised, covariance, filled", "pcl_organised_planes", "covariance", "PCL"},
      {"PCL organised, gradient, filled", "pcl_organised_planes", "gradient", "PCL"},
      {"PCL organised, covariance, holes", "pcl_organised_planes", "covariance-holes", "PCL"},
      {"PCL organised, gradient, holes", "pcl_organised_planes", "gradient-holes", "PCL"},
      {"CGAL efficient RANSAC", "cgal_ransac_planes", "planes", "CGAL", true},
      {"CGAL region growing", "cgal_growing_planes", "sorted", "CGAL", true},
      {"Open3D plane peeling", "open3d_planes", "peeling", "Open3D", true},
      {"AHC / PEAC", "ahc_planes", "", ""}};
  for (const auto& peer : peers) job.programs.push_back(program_of(setup, peer, {}));
  return job;
}

Job squares_job(const Setup& setup) {
  Job job{"squares only", cases_of(setup), {}};
  std::erase_if(job.cases, [](const Case& at) { return at.probe; });
  Program stage = squares_of(setup, {"hybrid, stage", "ours_squares", "", "OpenCL", false, true});
  stage.ours = true;
  stage.run = [=, inner = stage.run](const Case& at) {
    if (!std::filesystem::exists(ours_range(setup, at))) run_ours(setup, at);
    return inner(at);
  };
  // One time is a host's with its copies, the other the device's alone: what the kernel itself would give a
  // caller.
  Program kernel;
  kernel.name = "hybrid, kernel alone";
  kernel.ours = kernel.large = true;
  kernel.missing = stage.missing;
  kernel.run_of = stage.name;
  kernel.figure = [](Run run) {
    run.seconds = run.report.at("parts").at("device");
    return run;
  };
  job.programs = {stage, kernel};
  const PlanesPeer peers[] = {{"C++/OpenMP, 32 test planes", "twin_planes", "32", "OpenMP", false, true},
                              {"C++/OpenMP, 16 test planes", "twin_planes", "16", "OpenMP"},
                              {"C++/OpenMP, 8 test planes", "twin_planes", "8", "OpenMP"},
                              {"PCL SACSegmentation", "pcl_square_planes", "32", "PCL"}};
  for (const auto& peer : peers) job.programs.push_back(squares_of(setup, peer));
  return job;
}

}  // namespace hybrid::compare
