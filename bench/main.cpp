#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "harness.hpp"

namespace hybrid::bench {

std::vector<Bench>& registry() {
  static std::vector<Bench> instance;
  return instance;
}

namespace {

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

// Device seconds of all launches of this bench during one run (kernel time, without copies), and the wall
// clock.
nlohmann::ordered_json measure(device::Queue& queue, const Bench& bench, int runs) {
  const auto prepared = bench.prepare();
  const auto& run = prepared.run;
  run(queue);  // builds the kernel and warms the caches
  std::vector<double> device_s, wall_s;
  for (int i = 0; i < runs; ++i) {
    const double before = queue.profile().count(bench.name) ? queue.profile().at(bench.name).seconds : 0;
    Timer timer;
    run(queue);
    wall_s.push_back(timer.seconds());
    device_s.push_back(queue.profile().at(bench.name).seconds - before);
  }
  const double median = quantile(device_s, 0.5);
  return {{"kernel", bench.name},
          {"variant", bench.variant},
          {"runs", runs},
          {"kernel_s", {{"median", median}, {"min", quantile(device_s, 0)}, {"max", quantile(device_s, 1)}}},
          {"wall_s_median", quantile(wall_s, 0.5)},
          {"items_per_s", prepared.items / median},
          {"bytes_per_s", prepared.bytes / median},
          {"flops_per_s", prepared.flops / median}};
}

}  // namespace
}  // namespace hybrid::bench

int main(int argc, char** argv) {
  using namespace hybrid;
  CLI::App app{
      "Times every kernel on one device and prints JSON: median and spread, items, bytes and flops per "
      "second"};
  std::string device, only;
  int runs = 7, threads = 0;
  app.add_option("--device", device, "cpu, gpu or an index of `hybrid devices`");
  app.add_option("--only", only, "run the kernels whose name contains this");
  app.add_option("--runs", runs, "counted runs per case")->check(CLI::Range(1, 1000));
  app.add_option("--threads", threads, "threads, 0 = all cores");
  CLI11_PARSE(app, argc, argv);
  try {
    set_thread_count(threads);
    device::Queue queue(device);
    auto& benches = bench::registry();
    std::sort(benches.begin(), benches.end(), [](const auto& a, const auto& b) {
      return std::tie(a.name, a.variant) < std::tie(b.name, b.variant);
    });
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const auto& bench : benches) {
      if (bench.name.find(only) == std::string::npos) continue;
      std::cerr << bench.name << " " << bench.variant << "\n";
      rows.push_back(bench::measure(queue, bench, runs));
    }
    std::cout << nlohmann::ordered_json{{"device", queue.device().name},
                                        {"driver", queue.device().driver_version},
                                        {"benches", rows}}
                     .dump(2)
              << "\n";
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return 1;
  }
}
