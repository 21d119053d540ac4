#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "report/html.hpp"

namespace hybrid::report {

// index.html of an archive: all its scenes and loose scans in tables that sort and filter, what failed and
// how to run it again, the scans that abstained, what the plan could not use. Made row by row, as all
// summaries of an archive of thousands of scenes would fill the memory.
class ArchivePage {
 public:
  ArchivePage();
  // A result, in the page's order: {"result", "kind": "scene" | "planes", "state", "page" (link or null),
  // "pictures": [{"scan", "file": its class picture, from the page}], "summary": of summary.json, or null},
  // and "error", "command" where it has them.
  void add(const Json& row);
  // What the plan could not use.
  void add_problem(const std::string& path, const std::string& what);
  // `folder`/index.html. report/timing.js beside it calls hybridTiming({"cpu_s_by_unit": {id: seconds}}).
  void write(const std::filesystem::path& folder, const std::string& title) const;

 private:
  void add_scene(const Json& row);
  void add_loose(const Json& row);
  void add_pictures(const Json& row);
  void add_abstained(const Json& row);
  void add_failure(const Json& row);
  std::string facts() const;

  Table scenes_, loose_, abstained_;
  std::string pictures_, failures_, problems_;
  std::map<std::string, std::size_t> count_of_state_;
  std::size_t scan_count_ = 0, registered_count_ = 0, abstained_count_ = 0, picture_count_ = 0;
};

}  // namespace hybrid::report
