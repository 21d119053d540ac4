#include "archive/outcome.hpp"

#include "core/log.hpp"

namespace hybrid::archive {
namespace {

constexpr ErrorKind kKinds[] = {ErrorKind::failed, ErrorKind::usage,     ErrorKind::input,
                                ErrorKind::device, ErrorKind::temporary, ErrorKind::interrupted};

bool has_object(UnitState state) {
  return state == UnitState::done || state == UnitState::partial;
}

}  // namespace

const char* name_of(UnitState state) {
  switch (state) {
    case UnitState::waiting:
      return "waiting";
    case UnitState::done:
      return "done";
    case UnitState::partial:
      return "partial";
    case UnitState::failed:
      return "failed";
    default:
      return "quarantined";
  }
}

const char* name_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "usage";
    case ErrorKind::input:
      return "input";
    case ErrorKind::device:
      return "device";
    case ErrorKind::temporary:
      return "temporary";
    case ErrorKind::interrupted:
      return "interrupted";
    default:
      return "failed";
  }
}

ErrorKind error_kind_from(const std::string& name) {
  for (const ErrorKind kind : kKinds)
    if (name == name_of(kind)) return kind;
  return ErrorKind::failed;
}

const Outcome& Outcomes::of(std::size_t unit) {
  if (!known_[unit]) known_[unit] = look(manifest_.units[unit]);
  return *known_[unit];
}

std::string Outcomes::key_of(const Unit& unit) {
  std::string others;
  for (const std::size_t need : unit.needs) {
    const Unit& needed = manifest_.units[need];
    const Outcome& outcome = of(need);
    if (outcome.state == UnitState::waiting) return "";
    if (outcome.state == UnitState::done && outcome.key == needed.key) continue;
    others += fmt::format("{} {} {} {}\n", needed.id, outcome.key,
                          has_object(outcome.state) ? "made" : "failed", outcome.error);
  }
  return others.empty() ? unit.key : hash_of(unit.key + "\n" + others);
}

Outcome Outcomes::look(const Unit& unit) {
  Outcome outcome;
  outcome.key = key_of(unit);
  if (outcome.key.empty()) return outcome;
  if (store_.has(outcome.key)) {
    try {
      const auto object = store_.object_json(outcome.key);
      outcome.state = object.value("status", "") == "done" ? UnitState::done : UnitState::partial;
      for (const auto& failure : object["failures"])
        outcome.error += (outcome.error.empty() ? "" : "; ") + failure["error"].get<std::string>();
      return outcome;
    } catch (const Error& error) {  // as if it were not there: it is made again
      log::warning("{}", error.what());
    }
  }
  if (const auto failure = store_.failure(outcome.key)) {
    outcome.error = failure->value("error", "");
    outcome.kind = error_kind_from(failure->value("error_kind", ""));
    outcome.attempts = failure->value("attempts", 1);
    outcome.finished = failure->value("finished", "");
    outcome.state = failure->value("quarantined", false) ? UnitState::quarantined : UnitState::failed;
  }
  return outcome;
}

}  // namespace hybrid::archive
