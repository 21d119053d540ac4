#include "batch/progress.hpp"

#include <unistd.h>

#include <cstdio>

#include "core/interrupt.hpp"
#include "core/log.hpp"

namespace hybrid::batch {

Progress::Progress(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1 && log::escapes_allowed()) {}

Progress::~Progress() {
  finish();
}

void Progress::step(const std::string& stage, const std::string& unit) {
  check_interrupted();
  close_step();
  stage_ = stage;
  timer_ = Timer();
  ++done_;
  if (quiet_) return;
  if (terminal_)
    std::fprintf(stderr, "\r\033[K[%d/%d] %s: %s", done_, expected_, unit.c_str(), stage.c_str());
  else
    log::info("[{}/{}] {}: {}", done_, expected_, unit, stage);
}

void Progress::close_step() {
  if (!stage_.empty()) seconds_[stage_] += timer_.seconds();
  stage_.clear();
}

void Progress::finish() {
  if (stage_.empty()) return;
  close_step();
  if (terminal_ && !quiet_) std::fprintf(stderr, "\r\033[K");
}

}  // namespace hybrid::batch
