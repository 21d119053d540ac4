#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid::archive {

// What a plan says about a path that it cannot use or leaves alone.
struct Remark {
  std::string path;  // relative to the archive
  std::string what;
};

// What lies in an archive, each list by path.
struct ArchiveContent {
  std::vector<std::filesystem::path> scenes;  // scene.toml and *.scene.toml
  // Files with the extension of a scan that lie in no folder of a scene, nor below one.
  std::vector<std::filesystem::path> loose;
  std::vector<std::filesystem::path> beside_scenes;  // those that do
  std::vector<Remark> problems;  // folders that cannot be read, links that go in circles, names not in UTF-8
  std::vector<Remark> notes;     // what was left out, and why
};

// Walks all folders below `archive`, links to folders included, each folder once. Left out: stores, output
// folders of `hybrid run` and `planes`, folders of parts beside range images, what begins with a dot. Throws
// ErrorKind::input when the archive itself is no readable folder.
ArchiveContent walk_archive(const std::filesystem::path& archive);

}  // namespace hybrid::archive
