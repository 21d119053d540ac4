#include "shared/planes_peer.hpp"

#include <ImfThreading.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "shared/labels_exr.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace hybrid::peers {

int planes_main(int argc, char** argv, const std::string& package, const std::vector<std::string>& variants,
                const PlanesBody& body) {
  CLI::App app{"Planes of a range.exr by " + package + "; prints one JSON object"};
  PlanesOptions options;
  options.variant = variants.front();
  std::string range, out;
  app.add_option("--range", range, "DIR/scans/ID/range.exr of hybrid planes")->required();
  app.add_option("--out", out, "folder for scans/ID/labels.exr")->required();
  app.add_option("--variant", options.variant, "settings")
      ->check(CLI::IsMember(variants))
      ->capture_default_str();
  app.add_option("--sigma", options.sigma_m, "range noise, metres")->check(CLI::Range(1e-5, 1.0));
  app.add_option("--square", options.square, "side of a square, samples")->check(CLI::Range(3, 16));
  app.add_flag("--squares-only", options.squares_only, "no planes: the squares' time alone");
  app.add_option("--threads", options.threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  return report_of([&] {
    if (options.threads == 0) options.threads = static_cast<int>(std::thread::hardware_concurrency());
#ifdef _OPENMP
    omp_set_num_threads(options.threads);
#endif
    Imf::setGlobalThreadCount(options.threads);
    const RangeScan scan = read_range_exr(range);
    Report report;
    report.package = package;
    const Stopwatch watch;
    const auto labels = body(scan, options, report);
    if (report.seconds == 0) report.seconds = watch.seconds();
    if (!options.squares_only) write_result_folder(out, range, scan.rows, scan.cols, labels);
    report.more["samples"] = scan.measured();
    report.more["threads"] = options.threads;
    report.more["planes"] = labels.empty() ? 0u : *std::max_element(labels.begin(), labels.end());
    return report;
  });
}

std::vector<std::uint32_t> valid_nodes(const RangeScan& scan) {
  std::vector<std::uint32_t> nodes;
  for (std::size_t i = 0; i < scan.count(); ++i)
    if (scan.mask[i] != 0) nodes.push_back(static_cast<std::uint32_t>(i));
  return nodes;
}

}  // namespace hybrid::peers
