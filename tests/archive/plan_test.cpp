// What a plan finds in an archive, and what it says of the rest.
#include <gtest/gtest.h>
#include <unistd.h>

#include "../e2e/bad_mini_scene.hpp"
#include "io/output.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

bool mentions(const nlohmann::json& remarks, const std::string& path, const std::string& what) {
  for (const auto& one : remarks)
    if (one["path"] == path && one["what"].get<std::string>().find(what) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST(ArchivePlan, finds_scenes_and_loose_scans_and_tells_of_the_rest) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive";
  write_small_archive(archive, 2);
  fs::copy_file(archive / "a/s.ply", archive / "a/beside.ply");
  fs::create_directories(archive / "loose/deep");
  fs::copy_file(archive / "a/s.ply", archive / "loose/deep/one.ply");
  io::write_text(archive / "loose/none.exr", "no image");
  io::write_text(archive / "loose/cut.e57", "ASTM-E57");
  fs::create_directory_symlink("..", archive / "loose/deep/up");
  fs::create_directory_symlink("../a", archive / "loose/again");
  fs::create_symlink("nowhere.e57", archive / "loose/gone.e57");
  io::write_text(archive / "broken/scene.toml", "[scene\n");
  io::write_text(archive / "b/other.scene.toml", mini_scene_text());
  io::write_text(archive / "results/summary.json", "{}");
  io::write_text(archive / "results/timing.json", "{}");
  fs::copy_file(archive / "a/s.ply", archive / "results/left-out.ply");

  const auto planned = plan(archive, scratch / "store");
  EXPECT_EQ(planned.exit_code, 3) << planned.err;
  const auto summary = json_of(planned);
  // a, b, b/other and broken; their three scans, one.ply and cut.e57
  EXPECT_EQ(summary["units"]["scene"]["count"], 4) << planned.out;
  EXPECT_EQ(summary["units"]["planes"]["count"], 5);
  EXPECT_EQ(summary["units"]["report"]["count"], 1);
  EXPECT_EQ(summary["problems"].size(), 4u) << planned.out;
  EXPECT_TRUE(mentions(summary["problems"], "broken/scene.toml", "no valid TOML"));
  EXPECT_TRUE(mentions(summary["problems"], "loose/cut.e57", "byte"));
  EXPECT_TRUE(mentions(summary["problems"], "loose/deep/up", "a link to a folder above it"));
  EXPECT_TRUE(mentions(summary["problems"], "loose/gone.e57", "a link to nothing"));
  EXPECT_TRUE(mentions(summary["notes"], "loose/again", "the same folder as a"));
  EXPECT_TRUE(mentions(summary["notes"], "loose/none.exr", "no scan that can be read"));
  EXPECT_TRUE(mentions(summary["notes"], "results", "results of a run"));
  EXPECT_TRUE(mentions(summary["notes"], "a", "1 files with a scan's extension"));
  EXPECT_TRUE(mentions(summary["notes"], "b", "\"mini\"")) << planned.out;

  // The same text again, and none when nothing is to be written.
  const auto manifest = io::read_text(scratch / "store/manifest.json");
  EXPECT_EQ(plan(archive, scratch / "store").exit_code, 3);
  EXPECT_EQ(io::read_text(scratch / "store/manifest.json"), manifest);
  EXPECT_EQ(plan(archive, scratch / "other", "--dry-run").out, manifest);
  const auto dry =
      run("hybrid batch plan " + archive.string() + " --dry-run --out " + (scratch / "other").string());
  for (const std::string& words : std::vector<std::string>{
           "     0  planes ", "  -           planes a s: " + (archive / "a/s.ply").string() + " scan 0\n",
           "  0           scene a: " + (archive / "a/scene.toml").string() + "\n", "     9  report",
           "  0-8         report: all of these\n"})
    EXPECT_NE(dry.out.find(words), std::string::npos) << words << "\n" << dry.out;
  EXPECT_FALSE(fs::exists(scratch / "other"));
}

TEST(ArchivePlan, says_what_is_wrong_with_its_arguments) {
  const Scratch scratch;
  write_small_archive(scratch / "archive", 1);
  const auto expect = [&](const Outcome& outcome, int code, const std::string& words) {
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  expect(plan(scratch / "nowhere", scratch / "store"), 4, "expected an archive's folder, found nothing");
  expect(plan(scratch / "archive", scratch / "archive"), 4, "expected a store or an empty folder");
  io::write_text(scratch / "p.toml", "[render]\nblnd = \"dual\"\n");
  expect(plan(scratch / "archive", scratch / "store", "--profile " + (scratch / "p.toml").string()), 4,
         "p.toml:2: [render]: unknown key \"blnd\"; did you mean \"blend\"?");
  io::write_text(scratch / "p.toml", "[[scene]]\nmatch = \"a\"\n\nplanes.square = 99\n");
  expect(plan(scratch / "archive", scratch / "store", "--profile " + (scratch / "p.toml").string()), 4,
         "p.toml:4: [planes]: square: expected a whole number from 3 to 16");
  io::write_text(scratch / "p.toml", "[export]\n");
  expect(plan(scratch / "archive", scratch / "store", "--profile " + (scratch / "p.toml").string()), 4,
         "p.toml:1: [export]: expected what is to be exported");
  io::write_text(scratch / "p.toml", "[run]\nsalvge = true\n");
  expect(plan(scratch / "archive", scratch / "store", "--profile " + (scratch / "p.toml").string()), 4,
         "p.toml:2");
  io::write_text(scratch / "p.toml", "[[scan]]\nfile = \"a.ply\"\n");
  expect(plan(scratch / "archive", scratch / "store", "--profile " + (scratch / "p.toml").string()), 4,
         "p.toml:1: unknown key \"scan\"; Known: run, scene, planes");
  EXPECT_FALSE(fs::exists(scratch / "store"));
  expect(run_store(scratch / "archive"), 4, "expected a store, found no store.json");
  io::write_text(scratch / "new/store.json", "{\"format\": \"hybrid store 1\"}");
  expect(run_store(scratch / "new"), 4,
         (scratch / "new").string() +
             ": expected a plan, found no manifest.json; make one by hybrid batch plan");
  ASSERT_EQ(plan(scratch / "archive", scratch / "store").exit_code, 0);
  expect(run_store(scratch / "store", "--unit 9"), 2, "expected units from 0 to 2");
  expect(run_store(scratch / "store", "--unit 1-"), 2, "expected numbers of units");
  expect(run_store(scratch / "store", "--memory lots"), 2, "expected a size such as 8G");
}

TEST(ArchivePlan, notes_an_override_for_scenes_that_are_not_there) {
  const Scratch scratch;
  write_small_archive(scratch / "archive", 2);
  io::write_text(scratch / "p.toml",
                 "[[scene]]\nmatch = \"b\"\nseed = 2\n[[scene]]\nmatch = \"abbey/*\"\nseed = 3\n");
  const auto planned =
      plan(scratch / "archive", scratch / "store", "--profile " + (scratch / "p.toml").string());
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  const auto notes = json_of(planned)["notes"];
  EXPECT_TRUE(mentions(notes, (scratch / "p.toml").string() + ":4",
                       "\"abbey/*\": expected the name of a scene or loose scan"))
      << notes;
  EXPECT_FALSE(mentions(notes, (scratch / "p.toml").string() + ":1", "")) << notes;
}

}  // namespace hybrid::e2e
