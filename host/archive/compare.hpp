#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "archive/night.hpp"
#include "io/scene/threshold_file.hpp"

namespace hybrid::archive {

// What differs between two nights, results paired by their names in the archive:
//   {"a", "b": {"store", "night", "archive"}, "build": [what differs of the programs],
//    "counts": {"same", "changed", "added", "removed", "better", "moved", "worse"},
//    "results": [{"result", "change": "changed" | "added" | "removed", "state": [before, after],
//                 "error", "objects": [key, key], "because": ["input scans/west.ply",
//                 "options/planes/square",
//                 ...], "figures": [{"of", "figure", "before", "after", "change", "relative", "verdict"}],
//                 "pictures": [{"path", "change"}]}]}
// A result whose object is the same is only counted. One that was done and is no more, or that is not there
// any more, is worse. Of pictures those that a page can show: PNG and JPEG but the report's own previews.
nlohmann::ordered_json compare_nights(const Night& a, const Night& b, const io::ThresholdFile& thresholds);

// For people: counts, then every figure that got worse, then those that moved.
std::string comparison_text(const nlohmann::ordered_json& comparison);

// 3 when a figure got worse by more than its threshold, else 0.
int exit_code(const nlohmann::ordered_json& comparison);

}  // namespace hybrid::archive
