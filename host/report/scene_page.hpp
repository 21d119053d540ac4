#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/html.hpp"

namespace hybrid::report {

struct PageFailure {
  std::string unit, error;
};

// What the page of one scene is made from. Everything else is read from DIR: scans/<id>/planes.json and
// pose.json, and the pictures that are there.
struct ScenePage {
  std::filesystem::path out;  // DIR
  Json summary;               // of summary.json
  std::vector<PageFailure> failures;
};

// DIR/report/index.html and DIR/report/pictures/: one page that opens from the disk, asks nothing of any
// network, and has the same bytes every run. Times and the commands that run a failed unit again stand in
// report/timing.js (batch::write_timing()), which the page loads. An older run's pictures are removed first.
void write_scene_page(const ScenePage& given);

}  // namespace hybrid::report
