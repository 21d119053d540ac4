#include <ImfThreading.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <thread>

#include "score/benchmark_score.hpp"
#include "score/error.hpp"
#include "score/report/score_json.hpp"
#include "score/report/score_table.hpp"

namespace {

constexpr int kFailed = 1, kUsage = 2, kBadInput = 4;

// JSON or tables on stdout.
void print_score(const std::filesystem::path& truth, const std::filesystem::path& results,
                 const score::ScoreOptions& options, bool json) {
  if (score::is_benchmark(truth)) {
    const score::BenchmarkScore benchmark = score::score_benchmark(truth, results, options);
    fmt::print("{}",
               json ? score::benchmark_json(benchmark).dump(1) + "\n" : score::benchmark_table(benchmark));
    return;
  }
  const score::SceneScore scene = score::score_scene(truth, results, options);
  fmt::print("{}", json ? score::scene_json(scene, options).dump(1) + "\n" : score::scene_table(scene));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "How far results are from the truth. bench/score/README.md defines every figure.\n"
      "TRUTH: truth.json of hybrid-synth; NAME.pcd, organised, with plane labels in `intensity` (SynPEB); "
      "or\n"
      "NAME.gt-seg of SegComp (NAME.gt-ang beside it is used when it is there).\n"
      "RESULTS: the folder of hybrid run, or one with range.exr and labels.exr; for SegComp also "
      "NAME.ms-seg.",
      "hybrid-score"};
  app.set_version_flag("--version", "hybrid-score 0.1.0");
  std::string truth, results;
  bool json = false;
  score::ScoreOptions options;
  app.add_option("TRUTH", truth, "what is true")->required();
  app.add_option("RESULTS", results, "what is to be scored")->required();
  app.add_flag("--json", json, "one JSON document on stdout instead of tables");
  app.add_option("--scan", options.scan, "only this scan");
  app.add_flag("--no-decimation{false}", options.decimation,
               "leave out how far discarded samples are from their planes");
  app.add_flag("--list-planes", options.list_planes,
               "every true plane, the region that shares most with it, and what keeps them apart");
  app.add_option("--min-samples", options.min_samples,
                 "true planes with fewer measured samples are not counted")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--wrong-deg", options.limits.deg, "an accepted pose is wrong beyond this rotation")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--wrong-mm", options.limits.mm, "an accepted pose is wrong beyond this distance")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--wrong-scale", options.limits.scale,
                 "an accepted pose is wrong beyond this relative error of scale")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem, std::cout, std::cerr) == 0 ? 0 : kUsage;
  }
  try {
    Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
    print_score(truth, results, options, json);
    return 0;
  } catch (const score::InputError& problem) {
    fmt::print(stderr, "hybrid-score: {}\n", problem.what());
    return kBadInput;
  } catch (const std::exception& problem) {
    fmt::print(stderr, "hybrid-score: {}\n", problem.what());
    return kFailed;
  }
}
