#pragma once
#include <filesystem>

#include "report/html.hpp"

namespace hybrid::report {

// `folder`/index.html: all scenes and loose scans of an archive in tables that sort and filter, what failed
// and how to run it again, the scans that abstained, what the plan could not use. From archive.json:
//   "results": [{"result", "kind": "scene" | "planes", "state", "page" (link or null), "error", "command",
//                "pictures": [{"scan", "file": its class picture, from the page}],
//                "summary": of summary.json, or null}], "problems": [{"path", "what"}]
// report/timing.js beside it calls hybridTiming({"cpu_s_by_unit": {id: seconds}}).
void write_archive_page(const std::filesystem::path& folder, const std::string& title, const Json& archive);

}  // namespace hybrid::report
