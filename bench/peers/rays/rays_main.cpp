// Our kernels and Embree (and nanoflann) on the same rays, photographs and queries, in turn within one
// process.
#include <omp.h>
#include <CLI/CLI.hpp>
#include <thread>

#include "core/parallel.hpp"
#include "rays/rays_jobs.hpp"

int main(int argc, char** argv) {
  using namespace hybrid;
  CLI::App app{
      "Rays, projected photographs and closest points by our kernels, Embree and nanoflann; prints JSON"};
  peers::RayOptions options;
  int threads = 0;
  app.add_option("--rounds", options.rounds, "counted runs")->check(CLI::Range(1, 100));
  app.add_option("--threads", threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  app.add_flag("--quick", options.quick, "without splats, 100,000 queries");
  app.add_option("--only", options.only, "jobs whose size contains this");
  CLI11_PARSE(app, argc, argv);
  return peers::report_of([&] {
    set_thread_count(threads);
    omp_set_num_threads(threads ? threads : static_cast<int>(std::thread::hardware_concurrency()));
    device::Queue queue;
    auto rows = nlohmann::ordered_json::array();
    const peers::Stopwatch watch;
    peers::room_jobs(queue, options, rows);
    peers::closest_jobs(queue, options, rows);
    peers::Report report{"hybrid", "rays", watch.seconds(), {}, {}};
    report.more["rows"] = rows;
    return report;
  });
}
