#pragma once
#include <nlohmann/json.hpp>

#include "archive/store.hpp"

namespace hybrid::archive {

// STORE/catalogue.sqlite, to be asked by SQL; made anew from the store's files each time and put in place by
// rename, so that readers always see a whole one, and nothing depends on it. Tables:
//   nights    night (newest 0), name, planned (UTC), archive, sources, build, device, units, problems
//   units     night, unit, id, kind, result, state, object, error: every plan's units as they stand now
//   inputs    night, unit, file, bytes, xxh3
//   objects   object, unit, kind, status, host, finished, seconds, cpu_s, memory_bytes, threads, files, bytes
//   figures   object, subject ("scan west", "view front", "scene"), name, value (a number), text (else)
//   failures  object, part, error, kind, attempts, quarantined, finished, command, log: of units that have no
//             object (part is the unit), and of the scans and views that failed inside one
//   problems  night, path, what
// and the view `history`: night, planned, result, subject, name, value: a figure night after night.
// Returns their counts, for people and --json. Holds no lock: an object that is removed meanwhile is left
// out.
nlohmann::ordered_json write_catalogue(const Store& store);

}  // namespace hybrid::archive
