#include "batch/stage_options.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace hybrid::testing {
namespace {

std::string rejection(const std::string& assignment) {
  batch::StageOptions options;
  try {
    options.set(assignment);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage) << assignment;
    return error.what();
  }
  ADD_FAILURE() << assignment << " was accepted";
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(StageOptions, an_assignment_sets_a_key_of_every_section_and_type) {
  batch::StageOptions options;
  options.set("render.blend=linear");
  options.set("render.weights=\"ulr\"");
  options.set("render.sigma_px=2.5");
  options.set("render.feather_px=12");
  options.set("render.ulr_k=3");
  options.set("planes.square=7");
  options.set("planes.min_squares=9");
  options.set("register.scale=free");
  EXPECT_EQ(options.render.blend, "linear");
  EXPECT_EQ(options.render.weights, "ulr");
  EXPECT_EQ(options.render.sigma_px, 2.5);
  EXPECT_FALSE(options.render.auto_sigma);
  options.set("render.sigma_px=auto");
  EXPECT_EQ(batch::describe(options)["render"]["sigma_px"], "auto");
  options.set("render.sigma_px=2.5");
  EXPECT_EQ(batch::describe(options)["render"]["sigma_px"], 2.5);
  EXPECT_EQ(options.render.feather_px, 12);
  EXPECT_EQ(options.render.ulr_k, 3);
  EXPECT_FALSE(options.auto_square);
  EXPECT_EQ(options.squares.square, 7);
  EXPECT_EQ(options.superclusters.min_squares, 9);
  EXPECT_TRUE(options.icp.free_scale);
}

TEST(StageOptions, an_assignment_goes_over_the_scene_file_and_the_last_one_counts) {
  io::SceneFile scene;
  scene.render["blend"] = {3, OptionValue(std::string("nearest"))};
  scene.render["sigma_px"] = {4, OptionValue(9.0)};
  const auto options = batch::read_stage_options(scene, {"render.blend=dual", "render.blend=linear"});
  EXPECT_EQ(options.render.blend, "linear");
  EXPECT_EQ(options.render.sigma_px, 9);
  EXPECT_EQ(batch::describe(options)["render"]["blend"], "linear");
}

TEST(StageOptions, a_wrong_assignment_says_what_is_wrong_with_it) {
  for (const char* shapeless : {"", "render", "render.blend", "blend=linear", "blend=a.b"})
    EXPECT_TRUE(contains(rejection(shapeless), "SECTION.KEY=VALUE")) << shapeless;
  EXPECT_TRUE(contains(rejection("rendr.blend=linear"), "planes, register, edit, render or export"));
  EXPECT_TRUE(contains(rejection("render.blnd=linear"), "\"blnd\"; did you mean \"blend\"?"));
  EXPECT_TRUE(contains(rejection("render.blnd=linear"), "sigma_px"));
  EXPECT_TRUE(contains(rejection("render.blend=cubic"), "nearest, linear, dual"));
  EXPECT_TRUE(contains(rejection("render.sigma_px=wide"), "\"wide\""));
  EXPECT_TRUE(contains(rejection("render.sigma_px=nan"), "from 0 to 50"));
  EXPECT_TRUE(contains(rejection("render.sigma_px=51"), "51"));
  EXPECT_TRUE(contains(rejection("render.ulr_k=2.5"), "a whole number"));
  EXPECT_TRUE(contains(rejection("planes.square=40"), "square"));
  EXPECT_TRUE(contains(rejection("render.sigma_px="), "sigma_px"));
  EXPECT_TRUE(contains(rejection("edit.openings=3"), "openings"));
  EXPECT_TRUE(contains(rejection("edit.clip=3"), "scene file"));
}

}  // namespace hybrid::testing
