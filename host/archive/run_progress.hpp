#pragma once
#include <cstddef>
#include <string>

#include "archive/outcome.hpp"
#include "core/timer.hpp"

namespace hybrid::archive {

// How far a run is: one rewritten line on a terminal, one JSON document per unit on stderr otherwise. The
// time left follows from the units' estimates and how long those that are done took.
class RunProgress {
 public:
  RunProgress(bool quiet, std::size_t units, double estimate_s);
  ~RunProgress();
  void unit_ended(const Unit& unit, const Outcome& outcome, double seconds);
  // A unit that another attempt will follow.
  void unit_again(const Unit& unit, const std::string& error);
  void show(std::size_t running, const std::string& one_of_them);

 private:
  double seconds_left() const;

  bool quiet_, terminal_;
  std::size_t units_, ended_ = 0, failed_ = 0;
  double estimate_s_, ended_estimate_s_ = 0;
  Timer timer_;
};

}  // namespace hybrid::archive
