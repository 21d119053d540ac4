#pragma once
#include <string>
#include <vector>

namespace hybrid::batch {

// What --dry-run has to say: inputs opened as far as their headers, nothing written.
struct DryRun {
  std::vector<std::string> lines;     // what would be done, from which inputs
  std::vector<std::string> problems;  // of inputs: each would fail its unit, or the run
  int exit_code = 0;                  // as the run's would be
};

}  // namespace hybrid::batch
