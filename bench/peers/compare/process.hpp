#pragma once
#include <string>
#include <vector>

namespace hybrid::compare {

struct Finished {
  int exit_code = 0;     // 128 + signal when one ended it
  bool stopped = false;  // by us, after the limit
  std::string output, errors;
  double wall_s = 0, cpu_s = 0, peak_mb = 0, limit_s = 0;
};

// Runs a program to its end with its output caught; past `limit_s` it is killed with all it has started.
// Throws std::runtime_error when it cannot be started.
Finished run_process(const std::vector<std::string>& command, double limit_s);

// What went wrong, in one line: the limit, the signal, or the exit status and the last line of its errors;
// empty when nothing did.
std::string failure_of(const Finished& finished);

std::string last_line(const std::string& text);

}  // namespace hybrid::compare
