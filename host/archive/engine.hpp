#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "archive/manifest.hpp"
#include "archive/store.hpp"

namespace hybrid::archive {

struct EngineOptions {
  std::optional<std::vector<std::size_t>> units;  // these alone; else all of the manifest
  int jobs = 0;                                   // units in flight; 0: one per core
  int threads = 0;                                // cores to use in all; 0: all
  std::uint64_t memory_bytes = 0;                 // for all units in flight; 0: four fifths of what is free
  std::uint64_t unit_memory_bytes = 0;            // a unit that takes more is ended; 0: memory_bytes
  double unit_seconds = 7200;                     // a unit that takes longer is ended
  int retries = 2;                                // of a unit whose process died, or that found the disk full
  bool retry = false;                             // also what failed by its input, and what is in quarantine
  std::string device, log_level = "info";
  bool quiet = false;
};

// What a run did and what the store holds now, for --json, and its exit code.
struct EngineResult {
  nlohmann::ordered_json summary;
  int exit_code = 0;
};

// Runs what the store lacks, several units at a time, each in a process of its own that takes one after the
// other and is replaced when it dies. A unit that fails is noted in the store (Store::failures) and the
// others go on. SIGINT and SIGTERM end the units in flight and the run, with exit code 130; a full disk that
// stays full ends it with 75, a machine without a device with 5. Links results. The caller holds the lock.
EngineResult run_units(const Store& store, const Manifest& manifest, const EngineOptions& options);

// For people.
std::string text_of(const EngineResult& result);

}  // namespace hybrid::archive
