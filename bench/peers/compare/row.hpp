#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hybrid::compare {

// One run of one program.
struct Run {
  double seconds = 0;  // from the input in memory to the result in memory, as the program says
  double wall_s = 0;   // the whole process
  double cpu_s = 0;  // the same, processor time of all threads: far below threads x wall_s on a busy machine
  double peak_mb = 0;  // largest resident set of the process; 0 = not measured
  nlohmann::json report;
};

enum class Outcome { ran, extrapolated, not_run };

// One line of the table: a program on one size of a job.
struct Row {
  std::string job, size, program, package, settings, quality;
  bool ours = false;
  double samples = 0;  // what the rate counts: samples, pixels, queries
  Outcome outcome = Outcome::ran;
  std::string reason;     // why not run; or the size that an extrapolation starts from
  std::vector<Run> runs;  // one, made up, when extrapolated
  nlohmann::json score;   // of the scorer, when there is one

  std::vector<double> seconds() const {
    std::vector<double> all;
    for (const Run& run : runs) all.push_back(run.seconds);
    return all;
  }
};

}  // namespace hybrid::compare
