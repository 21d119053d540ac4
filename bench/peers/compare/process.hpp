#pragma once
#include <string>
#include <vector>

namespace hybrid::compare {

struct Finished {
  int exit_code = 0;     // 128 + signal when one ended it
  bool stopped = false;  // by us, after the limit
  std::string output, errors;
  double wall_s = 0, peak_mb = 0;
};

// Runs a program to its end with its output caught; past `limit_s` it is killed. Throws std::runtime_error
// when it cannot be started.
Finished run_process(const std::vector<std::string>& command, double limit_s);

}  // namespace hybrid::compare
