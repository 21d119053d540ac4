#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "archive/store_lock.hpp"
#include "archive/worker_process.hpp"
#include "core/error.hpp"
#include "core/timer.hpp"

namespace hybrid::archive {

// How a unit's run ended, as the engine learns it.
struct Ending {
  bool ok = false;
  bool worker_died = false;  // by itself: perhaps not the unit's fault
  ErrorKind kind = ErrorKind::failed;
  std::string error;
};

// A worker of the engine, and the unit it runs.
struct Slot {
  std::unique_ptr<WorkerProcess> worker;
  bool ready = false;
  std::optional<std::size_t> unit;
  std::string key;
  std::filesystem::path work;
  std::unique_ptr<KeyLock> lock;  // where other runs may make the same
  Timer timer;
  std::string killed_for;  // why the engine ended it; "" when it did not
  bool requeue = false;    // ended to make room
  bool budget = false;     // its memory is kept near all that there is
};

}  // namespace hybrid::archive
