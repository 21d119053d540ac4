#pragma once
#include <map>
#include <string>

#include "core/timer.hpp"

namespace hybrid::batch {

// Says on stderr what is being done: one rewritten line on a terminal, one log line per step otherwise. Adds
// up seconds per stage for timing.json. Every step is also a place where an interrupt ends the run cleanly.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Starts step `stage` ("planes") of `unit` ("scan west"); the one before it ends.
  void step(const std::string& stage, const std::string& unit);
  void finish();
  void expect(int steps) { expected_ += steps; }

  const std::map<std::string, double>& seconds_by_stage() const { return seconds_; }

 private:
  void close_step();

  bool quiet_, terminal_;
  int done_ = 0, expected_ = 0;
  std::string stage_;
  Timer timer_;
  std::map<std::string, double> seconds_;
};

}  // namespace hybrid::batch
