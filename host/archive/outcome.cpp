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

std::string in_batch_words(std::string error) {
  constexpr std::string_view kOption = "--salvage";
  const std::string key = "salvage = true in [run] of a profile (hybrid batch plan --profile)";
  for (auto at = error.find(kOption); at != std::string::npos; at = error.find(kOption, at + key.size()))
    error.replace(at, kOption.size(), key);
  return error;
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
                          has_object(outcome.state) ? "made" : "failed", outcome.cause);
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
        outcome.cause += (outcome.cause.empty() ? "" : "; ") + failure["error"].get<std::string>();
      outcome.error = in_batch_words(outcome.cause);
      return outcome;
    } catch (const Error& error) {  // as if it were not there: it is made again
      log::warning("{}", error.what());
    }
  }
  if (const auto failure = store_.failure(outcome.key)) {
    outcome.cause = failure->value("error", "");
    outcome.error = in_batch_words(outcome.cause);
    outcome.kind = error_kind_from(failure->value("error_kind", ""));
    outcome.attempts = failure->value("attempts", 1);
    outcome.finished = failure->value("finished", "");
    outcome.state = failure->value("quarantined", false) ? UnitState::quarantined : UnitState::failed;
  }
  return outcome;
}

}  // namespace hybrid::archive
