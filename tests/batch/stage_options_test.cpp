#include "batch/stage_options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "batch/option_text.hpp"
#include "core/error.hpp"
#include "io/files.hpp"

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

// Every key that a section takes, with the default that it has.
TEST(StageOptions, the_list_of_options_is_a_scene_file_that_changes_nothing) {
  const auto notes = batch::option_notes();
  EXPECT_GT(notes.size(), 80u);
  const TemporaryFolder folder;
  const auto scene = io::read_scene_file(
      folder.write("scene.toml", "[[scan]]\nfile = \"a.ply\"\n\n" + batch::option_text(notes)));
  EXPECT_EQ(batch::describe(batch::read_stage_options(scene)), batch::describe(batch::StageOptions()));
  std::size_t read = 0;
  for (const auto* section :
       {&scene.planes, &scene.registration, &scene.edit, &scene.render, &scene.exporting})
    read += section->size();
  std::vector<std::string> from_elsewhere;
  for (const auto& note : notes)
    if (note.value.is_null()) from_elsewhere.push_back(note.section + "." + note.key);
  EXPECT_EQ(from_elsewhere, std::vector<std::string>{"register.levelled"});
  EXPECT_EQ(read + 1, notes.size());
  const auto upright = io::read_scene_file(
      folder.write("upright.toml",
                   "[scene]\nlevelled = true\n[[scan]]\nfile = \"a.ply\"\n\n" + batch::option_text(notes)));
  EXPECT_TRUE(batch::read_stage_options(upright).alignment.levelled);
  const auto used = batch::describe(batch::StageOptions());
  for (const auto& [section, keys] : used.items())
    for (const auto& [key, value] : keys.items())
      EXPECT_TRUE(std::any_of(notes.begin(), notes.end(),
                              [&, &of = section, &name = key](const batch::OptionNote& note) {
                                return note.section == of && note.key == name;
                              }))
          << section << '.' << key;
  for (const auto& note : notes) {
    EXPECT_FALSE(note.help.empty()) << note.key;
    if (note.is_number) {
      EXPECT_LE(note.least, note.most) << note.key;
    }
  }
}

TEST(StageOptions, some_sections_of_the_list_alone) {
  for (const auto& note : batch::option_notes({"edit", "export"}))
    EXPECT_TRUE(note.section == "edit" || note.section == "export");
  const auto list = batch::option_json(batch::option_notes({"render"}));
  const auto blend =
      std::find_if(list.begin(), list.end(), [](const auto& one) { return one["key"] == "blend"; });
  ASSERT_NE(blend, list.end());
  EXPECT_EQ((*blend)["default"], "linear");
  EXPECT_EQ((*blend)["choices"].size(), 4u);
}

// The example of host/io/scene/README.md.
TEST(StageOptions, the_example_of_the_page_about_scene_files_is_one) {
  std::ifstream page(HYBRID_SCENE_PAGE);
  ASSERT_TRUE(page) << HYBRID_SCENE_PAGE;
  const std::string text((std::istreambuf_iterator<char>(page)), std::istreambuf_iterator<char>());
  const auto begin = text.find("```toml\n"), end = text.find("```\n", begin + 8);
  ASSERT_NE(end, std::string::npos);
  const TemporaryFolder folder;
  const auto scene = io::read_scene_file(folder.write("scene.toml", text.substr(begin + 8, end - begin - 8)));
  ASSERT_EQ(scene.scans.size(), 4u);
  EXPECT_EQ(scene.scans[0].landmarks.size(), 3u);
  EXPECT_TRUE(scene.scans[1].pose && scene.scans[1].fixed && scene.scans[1].scanner);
  EXPECT_EQ(scene.scans[2].unit_m, 0.001);
  EXPECT_EQ(scene.scans[2].axes, io::ScanAxes::camera);
  EXPECT_TRUE(scene.scans[3].depth);
  EXPECT_TRUE(scene.model && scene.photographs);
  EXPECT_GT(scene.views.size(), 100u);
  batch::read_stage_options(scene);
}

}  // namespace hybrid::testing
