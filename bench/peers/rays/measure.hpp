#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device/queue.hpp"
#include "shared/peer_report.hpp"

namespace hybrid::peers {

// One program's way of doing a job; `run` returns seconds.
struct Contender {
  std::string program, package, settings;
  bool ours = false;
  std::function<double()> run;
  std::function<std::string()> quality;  // after its last run; may be absent
};

// All contenders once to warm up, then in turn, round after round (A B C A B C); one entry for each, as
// hybrid-compare reads them.
inline void measure(const std::string& job, const std::string& size, double items, int rounds,
                    const std::vector<Contender>& contenders, nlohmann::ordered_json& rows) {
  std::vector<std::vector<double>> seconds(contenders.size());
  std::vector<std::string> quality(contenders.size());
  for (int round = -1; round < rounds; ++round)
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const double taken = contenders[i].run();
      if (round >= 0) seconds[i].push_back(taken);
      // Here, while the results in memory are this one's.
      if (round == rounds - 1 && contenders[i].quality) quality[i] = contenders[i].quality();
    }
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const Contender& one = contenders[i];
    rows.push_back({{"job", job},
                    {"size", size},
                    {"program", one.program},
                    {"package", one.package},
                    {"settings", one.settings},
                    {"quality", quality[i]},
                    {"ours", one.ours},
                    {"items", items},
                    {"seconds", seconds[i]}});
  }
}

// Device seconds that a run adds to the launches of one kernel.
template <typename Body>
double kernel_seconds(device::Queue& queue, const std::string& kernel, const Body& body) {
  const auto so_far = [&] {
    return queue.profile().count(kernel) ? queue.profile().at(kernel).seconds : 0.0;
  };
  const double before = so_far();
  body();
  queue.finish();
  return so_far() - before;
}

// Wall clock of a run.
template <typename Body>
double wall_seconds(const Body& body) {
  const Stopwatch watch;
  body();
  return watch.seconds();
}

}  // namespace hybrid::peers
