// Scans without a scene file.
#include "io/scene/implied_scene.hpp"

#include "files.hpp"

namespace hybrid::io::implied_scene_test {
namespace {
namespace fs = std::filesystem;
using Names = std::vector<std::string>;

Names names_of(const SceneFile& scene) {
  Names names;
  for (const auto& scan : scene.scans) names.push_back(scan.file.filename().string());
  return names;
}

std::string error_of(const fs::path& path) {
  try {
    read_scene_file(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(ImpliedScene, is_what_lies_in_a_folder) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"b.e57", "a.PTX", "c.ply", "notes.txt", ".hidden.ply", "below/d.ply", "no.exr"})
    folder.write(fs::path("west wing") / name, "");
  const fs::path place = folder.path() / "west wing";
  const auto scene = read_scene_file(place);
  EXPECT_TRUE(scene.implied);
  EXPECT_EQ(scene.name, "west wing");
  EXPECT_EQ(names_of(scene), (Names{"a.PTX", "b.e57", "c.ply"}));
  EXPECT_EQ(scene.path.parent_path(), place);
  EXPECT_FALSE(scene.model);
  EXPECT_EQ(read_scene_file(place / "").name, "west wing");

  const auto file = read_scene_file(place / "b.e57");
  EXPECT_TRUE(file.implied);
  EXPECT_EQ(file.name, "b");
  EXPECT_EQ(names_of(file), Names{"b.e57"});
  EXPECT_EQ(file.path, place / "b.e57");
}

TEST(ImpliedScene, gives_way_to_a_scene_file) {
  const testing::TemporaryFolder folder;
  folder.write("x/a.ply", "");
  folder.write("x/one.scene.toml", "[scene]\nname = \"one\"\n[[scan]]\nfile = \"a.ply\"\n");
  EXPECT_EQ(read_scene_file(folder.path() / "x").name, "one");
  folder.write("x/two.scene.toml", "[[scan]]\nfile = \"a.ply\"\n");
  EXPECT_NE(error_of(folder.path() / "x").find("expected one scene, found one.scene.toml and 1 more"),
            std::string::npos);
  folder.write("x/scene.toml", "[scene]\nname = \"all\"\n[[scan]]\nfile = \"a.ply\"\n");
  const auto scene = read_scene_file(folder.path() / "x");
  EXPECT_EQ(scene.name, "all");
  EXPECT_FALSE(scene.implied);
}

TEST(ImpliedScene, needs_scans) {
  const testing::TemporaryFolder folder;
  folder.write("x/readme.txt", "");
  EXPECT_NE(error_of(folder.path() / "x").find("found a folder with neither a scene.toml nor scans (.e57"),
            std::string::npos)
      << error_of(folder.path() / "x");
  EXPECT_NE(error_of(folder.path() / "nowhere.ply").find("nowhere.ply"), std::string::npos);
}

}  // namespace hybrid::io::implied_scene_test
