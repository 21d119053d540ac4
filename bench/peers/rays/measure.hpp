#pragma once
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device/queue.hpp"
#include "shared/peer_report.hpp"

namespace hybrid::peers {

// Of one run: the clock on the wall, and the processor time of all threads, which other programs disturb
// less.
struct Spent {
  double wall_s = 0, cpu_s = 0;
};

// One program's way of doing a job.
struct Contender {
  std::string program, package, settings;
  bool ours = false;
  std::function<Spent()> run;
  std::function<std::string()> quality;  // after its last run; may be absent
};

// All contenders once to warm up, then in turn, round after round (A B C A B C); one entry for each, as
// hybrid-compare reads them.
inline void measure(const std::string& job, const std::string& size, double items, int rounds,
                    const std::vector<Contender>& contenders, nlohmann::ordered_json& rows) {
  std::vector<std::vector<double>> seconds(contenders.size()), cpu_seconds(contenders.size());
  std::vector<std::string> quality(contenders.size());
  for (int round = -1; round < rounds; ++round)
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const Spent taken = contenders[i].run();
      if (round >= 0) seconds[i].push_back(taken.wall_s);
      if (round >= 0) cpu_seconds[i].push_back(taken.cpu_s);
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
                    {"seconds", seconds[i]},
                    {"cpu_seconds", cpu_seconds[i]}});
  }
}

inline double process_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <typename Body>
Spent spent_on(const Body& body) {
  const Stopwatch watch;
  const double before = process_seconds();
  body();
  return {watch.seconds(), process_seconds() - before};
}

// Device seconds that a run adds to the launches of one kernel; of a run that copies, too.
template <typename Body>
Spent kernel_seconds(device::Queue& queue, const std::string& kernel, const Body& body) {
  const auto so_far = [&] {
    return queue.profile().count(kernel) ? queue.profile().at(kernel).seconds : 0.0;
  };
  const double before = so_far();
  body();
  queue.finish();
  return {so_far() - before, 0};
}

// Launches and their end, with the data on the device.
template <typename Body>
Spent spent_on_device(device::Queue& queue, const Body& body) {
  queue.finish();
  return spent_on([&] {
    body();
    queue.finish();
  });
}

}  // namespace hybrid::peers
