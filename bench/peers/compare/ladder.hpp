#pragma once
#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "compare/row.hpp"

namespace hybrid::compare {

// One size of a job.
struct Case {
  std::string size;          // "20 MP"
  double samples = 0;        // known before it runs, for predictions
  bool probe = false;        // only there so that slow programs have something to be extrapolated from
  bool large = false;        // only programs that say so run it, unless all is asked for
  std::string missing = {};  // why nothing can run at this size; empty = it can
};

// What a run needs is not there, through no fault of the program: no reason not to try a larger size.
struct NoInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Program {
  std::string name;
  bool ours = false;
  bool slow = false;    // runs probes, and may be extrapolated from one
  bool large = false;   // runs the large sizes
  std::string missing;  // why it cannot run; empty = it can
  std::function<Run(const Case&)> run;
  std::function<void(const Case&, Row&)> score;  // fills quality; may be absent
  // Another figure of a run of the program of this name, earlier in the list, instead of a run of its own;
  // `run` is absent then.
  std::string run_of;
  std::function<Run(const Run&)> figure;
};

struct Job {
  std::string name;
  std::vector<Case> cases;        // ascending
  std::vector<Program> programs;  // ours first: what it writes may be the peers' input
  bool larger_is_harder = true;   // a peer that fails is not tried at the next size
};

struct LadderOptions {
  int rounds = 3;
  double peer_limit_s = 60;    // a program that would take longer is extrapolated ...
  bool full = false;           // ... unless asked for
  double repeat_limit_s = 10;  // no further round for a program that would then have had longer at one size
  std::chrono::steady_clock::time_point repeats_end = std::chrono::steady_clock::time_point::max();
  double memory_mb = 0;  // a program that would need more is extrapolated; 0 = no limit
  std::function<void(const std::string&)> say;  // progress, may be absent
};

// Every program on every size: round after round, all programs in turn (A B C A B C), so that what disturbs
// the machine disturbs all. A run that throws makes the row say so.
std::vector<Row> run_ladder(const Job& job, const LadderOptions& options);

}  // namespace hybrid::compare
