#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "geometry/pose.hpp"

namespace hybrid::e2e {

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

// Runs a shell command line and collects what it prints; `hybrid` and `hybrid-synth` mean this build's
// programs.
Outcome run(const std::string& command_line);

// The tiny synthetic room and the result of one run over it: made by ctest's fixtures (tests/CMakeLists.txt).
std::filesystem::path room();
std::filesystem::path result();

// An empty folder of this test's own, removed with everything in it when the object ends.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

nlohmann::json json_of(const std::filesystem::path& file);

// That a run found; from its pose.json.
Pose pose_of(const std::filesystem::path& out, const std::string& scan);

// The scene with the pose of that place (1 = the first) of the scan's places.toml, as a person copies it.
std::string with_place(std::string scene, const std::filesystem::path& out, const std::string& scan,
                       std::size_t place);

// timing.json and its copy for the report's page: the files that may differ between runs.
bool is_timing(const std::filesystem::path& name);

// Every file below `folder` but those of times: relative path and XXH3 of its content, one per line, sorted.
std::string content_list(const std::filesystem::path& folder);

}  // namespace hybrid::e2e
