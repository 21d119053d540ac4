// Scans without a scene file.
#include "io/scene/implied_scene.hpp"

#include "files.hpp"
#include "io/e57/e57_writer.hpp"

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

TEST(ImpliedScene, is_not_taken_where_a_scene_file_has_another_name) {
  const testing::TemporaryFolder folder;
  folder.write("x/a.ply", "");
  folder.write("x/notes.toml", "[planes]\nsquare = 5\n[[scene]]\nmatch = \"a\"\n");  // a profile
  folder.write("x/broken.toml", "[scan\n");
  EXPECT_TRUE(read_scene_file(folder.path() / "x").implied);
  folder.write("x/church.toml", "[[scan]]\nfile = \"a.ply\"\n");
  EXPECT_TRUE(is_scene_by_another_name(folder.path() / "x/church.toml"));
  EXPECT_NE(error_of(folder.path() / "x").find("found church.toml, a scene file by another name"),
            std::string::npos)
      << error_of(folder.path() / "x");
  EXPECT_EQ(read_scene_file(folder.path() / "x/church.toml").name, "church");
}

TEST(ImpliedScene, leaves_out_e57_files_of_photographs_alone) {
  const testing::TemporaryFolder folder;
  folder.write("x/a.ply", "");
  {
    E57Writer writer(folder.path() / "x/photographs.e57");
    E57Image image{.name = "a", .projection = E57Projection::pinhole, .width = 4, .height = 2};
    image.guid = "{a}";
    image.focal_length_m = 0.02;
    image.pixel_width = image.pixel_height = 1e-4;
    writer.add_image(image, "a picture", "");
    writer.close();
  }
  EXPECT_TRUE(holds_photographs_alone(folder.path() / "x/photographs.e57"));
  EXPECT_EQ(names_of(read_scene_file(folder.path() / "x")), Names{"a.ply"});
  EXPECT_FALSE(holds_photographs_alone(folder.write("x/empty.e57", "")));
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
