#include "archive/run_progress.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "core/json_text.hpp"
#include "core/log.hpp"

namespace hybrid::archive {
namespace {

void say(const nlohmann::ordered_json& json) {
  std::fprintf(stderr, "%s\n", json_text(json, -1).c_str());
}

std::string clock(double seconds) {
  const auto whole = static_cast<long>(seconds);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

RunProgress::RunProgress(bool quiet, std::size_t units, double estimate_s)
    : quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1 && log::escapes_allowed()),
      units_(units),
      estimate_s_(estimate_s) {}

RunProgress::~RunProgress() {
  if (!quiet_ && terminal_) std::fprintf(stderr, "\r\033[K");
}

double RunProgress::seconds_left() const {
  if (ended_estimate_s_ <= 0) return NAN;
  return timer_.seconds() * (estimate_s_ - ended_estimate_s_) / ended_estimate_s_;
}

void RunProgress::unit_ended(const Unit& unit, const Outcome& outcome, double seconds) {
  ++ended_;
  ended_estimate_s_ += unit.estimate_s;
  const bool failed = outcome.state == UnitState::failed || outcome.state == UnitState::quarantined;
  failed_ += failed;
  if (terminal_) {
    if (!outcome.error.empty()) std::fprintf(stderr, "\r\033[K");
    if (!outcome.error.empty()) log::error("{} {}: {}", unit.id, name_of(outcome.state), outcome.error);
    return;
  }
  if (quiet_ && !failed) return;
  nlohmann::ordered_json line = {
      {"event", "unit"},    {"unit", unit.number}, {"id", unit.id}, {"state", name_of(outcome.state)},
      {"seconds", seconds}, {"ended", ended_},     {"of", units_},  {"failed", failed_}};
  if (const double left = seconds_left(); std::isfinite(left)) line["eta_s"] = std::round(left);
  if (!outcome.error.empty()) line["error"] = outcome.error;
  say(line);
}

void RunProgress::unit_again(const Unit& unit, const std::string& error) {
  if (terminal_)
    log::warning("{}: {}; once more", unit.id, error);
  else
    say({{"event", "again"}, {"unit", unit.number}, {"id", unit.id}, {"error", error}});
}

void RunProgress::show(std::size_t running, const std::string& one_of_them) {
  if (quiet_ || !terminal_) return;
  const double left = seconds_left();
  std::fprintf(stderr, "\r\033[K[%zu/%zu] %zu running%s, %s left: %s", ended_, units_, running,
               failed_ ? fmt::format(", {} failed", failed_).c_str() : "",
               std::isfinite(left) ? clock(left).c_str() : "?", one_of_them.c_str());
  std::fflush(stderr);
}

}  // namespace hybrid::archive
