#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid::e2e {

// A box room with one scan of 7 000 points, two photographs of 64 x 48 and two views, one of them with its
// photograph left out: the smallest scene of which a run writes every kind of output. A run takes about half
// a second. Every test that damages something has its own copy.
void write_mini_scene(const std::filesystem::path& folder);

// The scene file's text, for tests that change it.
std::string mini_scene_text();

// All files of a run of it, relative to the output folder.
std::vector<std::string> mini_outputs();

// The scene and one run over it, for comparison: made by ctest's fixture (tests/CMakeLists.txt).
std::filesystem::path mini_scene();
std::filesystem::path mini_result();

}  // namespace hybrid::e2e
