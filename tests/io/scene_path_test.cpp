#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "io/files.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::io::scene_path_test {
namespace {

SceneFile read(const std::string& paths) {
  const testing::TemporaryFolder folder;
  return read_scene_file(folder.write("scene.toml", "[model]\nfile = \"box.obj\"\n" + paths));
}

const std::string kPath = "[[path]]\nname = \"p\"\nframes = 4\n";

}  // namespace

TEST(ScenePath, a_turntable_goes_round_once_and_looks_at_its_centre) {
  const auto views =
      read(kPath + "centre = [1, 2, 3]\nradius = 5\nheight = 2\nsize = [40, 30]\nshow = \"scan\"\n").views;
  ASSERT_EQ(views.size(), 4u);
  const Vec3 eyes[] = {{6, 2, 5}, {1, 7, 5}, {-4, 2, 5}, {1, -3, 5}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(views[i].name, "p/000" + std::to_string(i));
    EXPECT_EQ(views[i].path, "p");
    EXPECT_LT((views[i].eye - eyes[i]).norm(), 1e-12) << i;
    EXPECT_EQ(views[i].target, Vec3(1, 2, 3));
    EXPECT_EQ(views[i].size, (std::array{40, 30}));
    EXPECT_EQ(views[i].show, "scan");
  }
  // Half a turn has both its ends.
  const auto half = read(kPath + "centre = [0, 0, 0]\nradius = 1\nturn_deg = -180\nstart_deg = 90\n").views;
  EXPECT_LT((half.front().eye - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((half.back().eye - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_GT(half[1].eye.x(), 0.8);  // clockwise, from Y over X
}

TEST(ScenePath, key_cameras_are_passed_at_constant_speed) {
  // The first leg is nine times as long as the second.
  const auto views =
      read(
          "[[path]]\nname = \"p\"\nframes = 101\neyes = [[0,0,0], [9,0,0], [10,0,0]]\ntargets = [[0,50,0]]\n")
          .views;
  ASSERT_EQ(views.size(), 101u);
  EXPECT_EQ(views.front().eye, Vec3(0, 0, 0));
  EXPECT_LT((views.back().eye - Vec3(10, 0, 0)).norm(), 1e-9);
  EXPECT_EQ(views[100].name, "p/0100");
  double longest = 0, shortest = 1e9, nearest = 1e9;
  for (std::size_t i = 0; i < 101; ++i) {
    nearest = std::min(nearest, (views[i].eye - Vec3(9, 0, 0)).norm());
    if (i == 0) continue;
    const double step = (views[i].eye - views[i - 1].eye).norm();
    longest = std::max(longest, step), shortest = std::min(shortest, step);
  }
  EXPECT_LT(nearest, longest);
  EXPECT_LT(longest, 1.05 * shortest);
}

TEST(ScenePath, a_closed_path_does_not_show_its_first_place_twice) {
  const auto views =
      read(kPath + "eyes = [[5,0,0], [0,5,0], [-5,0,0], [0,-5,0]]\ntargets = [[0,0,0]]\nclosed = true\n")
          .views;
  const Vec3 eyes[] = {{5, 0, 0}, {0, 5, 0}, {-5, 0, 0}, {0, -5, 0}};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((views[i].eye - eyes[i]).norm(), 1e-2) << i;
}

TEST(ScenePath, one_frame_is_where_the_path_begins) {
  const auto views =
      read("[[path]]\nname = \"p\"\nframes = 1\neyes = [[1,0,0], [2,0,0]]\ntargets = [[0,5,0], [0,6,0]]\n")
          .views;
  ASSERT_EQ(views.size(), 1u);
  EXPECT_EQ(views[0].eye, Vec3(1, 0, 0));
  EXPECT_EQ(views[0].target, Vec3(0, 5, 0));
}

TEST(ScenePath, mistakes_name_line_and_key) {
  const struct {
    std::string text, line, message;
  } cases[] = {
      {"[[path]]\nframes = 4\n", "3", "expected the key name"},
      {"[[path]]\nname = \"../out\"\nframes = 4\n", "4", "usable as a folder"},
      {"[[path]]\nname = \"leave-one-out\"\nframes = 4\n", "4", "another name"},
      {"[[path]]\nname = \"p\"\n", "3", "frames: expected from 1 to 100000, found 0"},
      {"[[path]]\nname = \"p\"\nframes = -1\n", "5", "frames"},
      {kPath, "3", "either centre and radius or eyes and targets, found neither"},
      {kPath + "centre = [0,0,0]\neyes = [[0,0,0],[1,0,0]]\n", "3", "found both"},
      {kPath + "centre = [0,0,0]\n", "3", "found no radius"},
      {kPath + "centre = [0,0,0]\nradius = 0\n", "7", "more than 0 m, found 0"},
      {kPath + "centre = [0,0,0]\nradius = 1\nclosed = true\n", "8", "belongs to key cameras"},
      {kPath + "centre = [0,0,0]\nradius = 1\nup = [0,0,0]\n", "8", "expected a direction"},
      {kPath + "eyes = [[0,0,0]]\ntargets = [[0,1,0]]\n", "6", "at least 2 points"},
      {kPath + "eyes = [[0,0,0],[1,0,0]]\n", "3", "found no targets"},
      {kPath + "eyes = [[0,0,0],[1,0,0]]\ntargets = [[0,1,0],[0,1,0],[0,1,0]]\n", "7",
       "each of the 2 eyes, found 3"},
      {kPath + "eyes = [[0,0,0],[2,0,0]]\ntargets = [[0,0,0]]\n", "3", "frame 0"},
      {kPath + "centre = [0,0,0]\nradius = 1\nspeed = 2\n", "8", "unknown key \"speed\""},
      {"[[view]]\nname = \"p\"\neye = [0,0,0]\ntarget = [0,1,0]\n" + kPath + "centre = [0,0,0]\nradius = 1\n",
       "8", "a name of its own"},
  };
  for (const auto& c : cases) {
    try {
      read(c.text);
      ADD_FAILURE() << c.text;
    } catch (const Error& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find(c.message), std::string::npos) << said << "\n" << c.text;
      EXPECT_NE(said.find(".toml:" + c.line + ":"), std::string::npos) << said << "\n" << c.text;
    }
  }
}

}  // namespace hybrid::io::scene_path_test
