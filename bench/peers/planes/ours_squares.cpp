// Our planes per square in the peers' frame: the stage that `hybrid planes` runs, from the same range image,
// without what comes before and after it. Seconds are the host's, copies and loading of the kernel included;
// `parts.device` is the kernel's alone.
#include <CLI/CLI.hpp>
#include <algorithm>

#include "core/parallel.hpp"
#include "io/exr/range_exr.hpp"
#include "shared/peer_report.hpp"
#include "stages/planes/square_planes.hpp"

int main(int argc, char** argv) {
  using namespace hybrid;
  CLI::App app{"Planes per square of a range.exr by hybrid; prints one JSON object"};
  std::string range, out;
  int threads = 0;
  bool squares_only = true;
  stages::SquarePlaneOptions options;
  app.add_option("--range", range, "DIR/scans/ID/range.exr of hybrid planes")->required();
  app.add_option("--out", out, "not used");
  app.add_flag("--squares-only", squares_only, "not used: there is no more");
  app.add_option("--square", options.square, "side of a square, samples")->check(CLI::Range(3, 16));
  app.add_option("--threads", threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  return peers::report_of([&] {
    set_thread_count(threads);
    const RangeImage image = io::read_range_exr(range);
    device::Queue queue;
    const peers::Stopwatch watch;
    const auto squares = stages::fit_square_planes(queue, image, options);
    peers::Report report;
    report.seconds = watch.seconds();
    report.package = "hybrid";
    double device_s = 0;
    for (const auto& [label, row] : queue.profile())
      if (label == "square_planes") device_s += row.seconds;
    report.parts["device"] = device_s;
    report.settings = std::to_string(options.hypotheses) + " test planes, " + std::to_string(squares.square) +
                      " x " + std::to_string(squares.square) + " squares, noise estimated";
    report.more["samples"] = std::count(image.mask.begin(), image.mask.end(), kMeasured);
    return report;
  });
}
