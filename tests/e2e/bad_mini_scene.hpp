#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid::e2e {

// A box room with one scan of 7 000 points, two photographs of 64 x 48 and two views, one of them with its
// photograph left out: the smallest scene of which a run writes every kind of output. A run takes about half
// a second. Every test that damages something has its own copy.
void write_mini_scene(const std::filesystem::path& folder);

// Where its scanner stands, and a pose a centimetre beside it.
inline const Vec3 kScanner_m(1.6, 1.3, 1.2);
inline const std::string kPose = "pose = [1, 0, 0, 1.61, 0, 1, 0, 1.29, 0, 0, 1, 1.2, 0, 0, 0, 1]";

// The scene file's text, for tests that change it.
std::string mini_scene_text();

// All files of a run of it, relative to the output folder.
std::vector<std::string> mini_outputs();

// The scene and one run over it, for comparison: made by ctest's fixture (tests/CMakeLists.txt).
std::filesystem::path mini_scene();
std::filesystem::path mini_result();

}  // namespace hybrid::e2e
