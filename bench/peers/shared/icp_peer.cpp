#include "shared/icp_peer.hpp"

#include <CLI/CLI.hpp>
#include <thread>

#include "shared/pose_json.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace hybrid::peers {

int icp_main(int argc, char** argv, const std::string& package, const std::vector<std::string>& variants,
             const IcpBody& body) {
  CLI::App app{"Registers points to a proxy by " + package + "; prints one JSON object"};
  IcpInput input;
  input.variant = variants.front();
  std::string source, start;
  app.add_option("--source", source, "points in the scan frame, of icp_job")->required();
  app.add_option("--target", input.proxy_file, "proxy.obj")->required();
  app.add_option("--start", start, "job.json of icp_job")->required();
  app.add_option("--variant", input.variant, "settings")
      ->check(CLI::IsMember(variants))
      ->capture_default_str();
  app.add_option("--threads", input.threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  return report_of([&] {
    if (input.threads == 0) input.threads = static_cast<int>(std::thread::hardware_concurrency());
#ifdef _OPENMP
    omp_set_num_threads(input.threads);
#endif
    input.source = read_points_ply(source);
    if (input.source.empty()) throw std::runtime_error(source + ": expected points, found none");
    input.proxy = read_proxy_obj(input.proxy_file);
    input.start = read_pose(start, "start");
    Report report;
    report.package = package;
    const Stopwatch watch;
    const IcpResult result = body(input, report);
    if (report.seconds == 0) report.seconds = watch.seconds();
    report.more["samples"] = input.source.size();
    report.more["threads"] = input.threads;
    if (result.iterations >= 0) report.more["iterations"] = result.iterations;
    report.more["world_from_scan"] = json_of(result.world_from_scan);
    return report;
  });
}

}  // namespace hybrid::peers
