#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "archive/manifest.hpp"
#include "archive/store.hpp"

namespace hybrid::archive {

// The state of every unit of the plan in force: {"store", "archive", "units": {state: count, ...}, "list":
// [{"unit", "id", "kind", "state", "key", "error", "attempts", "finished", "command", "log", "result"}],
// "problems": [...]}.
nlohmann::ordered_json store_status(const Store& store, const Manifest& manifest);
// A table for people: counts by kind, then what is not done and how to run it again.
std::string status_text(const nlohmann::ordered_json& status);

// Reads every object, compares every file with its checksum, and looks for files that no checksum knows:
// {"objects", "files", "bytes", "damaged": [{"path", "what"}]}. With `remove` damaged objects go, so that the
// next run makes them again.
nlohmann::ordered_json verify_store(const Store& store, bool remove);

// Removes objects and failures that no manifest names, not even with a failed scan of theirs, after all but
// the newest `keep` manifests (0: all kept) are dropped; one without units, as of an archive that was
// not mounted, is none of these: {"removed", "bytes", "kept", "manifests_dropped"}.
// With `dry_run` says only what would go. The caller holds the lock alone.
nlohmann::ordered_json prune_store(const Store& store, std::size_t keep, bool dry_run);

}  // namespace hybrid::archive
