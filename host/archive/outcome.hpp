#pragma once
#include <optional>
#include <string>
#include <vector>

#include "archive/manifest.hpp"
#include "archive/store.hpp"
#include "core/error.hpp"

namespace hybrid::archive {

enum class UnitState {
  waiting,  // nobody has made it yet, or what it needs
  done,     // its object is there
  partial,  // its object is there, and says which of its scans or views failed
  failed,   // a failure is noted: one that comes again as long as the input stays, or one to be tried again
  quarantined,  // failed three times for no reason of its input's: left alone until asked for
};
const char* name_of(UnitState state);

// A unit that is to be tried no more counts as failed for those that need it: they go on without.
struct Outcome {
  UnitState state = UnitState::waiting;
  std::string key;    // of the object, or of the failure; "" while a unit that it needs waits
  std::string cause;  // why it failed, as the run said it; what the key of another unit may be made of
  std::string error;  // the same as `hybrid batch` tells it (in_batch_words)
  ErrorKind kind = ErrorKind::failed;
  int attempts = 0;
  std::string finished;  // of failures
};

inline constexpr int kMostAttempts = 3;

// What the store says of a manifest's units, each looked up once and again after forget(). A unit's key is
// the manifest's while all that it needs is done; a failed scan of a scene, and anything that a report tells
// of, enter the key: what comes out is another object, and the manifest's own is made as soon as the scan is
// mended.
class Outcomes {
 public:
  Outcomes(const Store& store, const Manifest& manifest)
      : store_(store), manifest_(manifest), known_(manifest.units.size()) {}

  const Outcome& of(std::size_t unit);
  // The store has changed for this unit.
  void forget(std::size_t unit) { known_[unit].reset(); }
  // Of a unit that is not to be tried again in this run though it may be in the next.
  void set(std::size_t unit, Outcome outcome) { known_[unit] = std::move(outcome); }

 private:
  std::string key_of(const Unit& unit);
  Outcome look(const Unit& unit);

  const Store& store_;
  const Manifest& manifest_;
  std::vector<std::optional<Outcome>> known_;
};

// What a run says, where it names options that `hybrid batch` takes from a profile.
std::string in_batch_words(std::string error);

// The failure's words for a kind, and back: "input", "failed", ...
const char* name_of(ErrorKind kind);
ErrorKind error_kind_from(const std::string& name);

}  // namespace hybrid::archive
