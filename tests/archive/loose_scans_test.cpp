// Loose scans that lie together are a scene: what of an archive is grouped, and what that costs and gives.
#include <gtest/gtest.h>

#include "../e2e/bad_mini_scene.hpp"
#include "io/output.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// A folder "job" with the two scans of the tiny room.
class LooseScans : public ::testing::Test {
 protected:
  LooseScans() {
    fs::create_directories(archive / "job");
    for (const char* id : {"west", "east"})
      fs::copy_file(room() / "scans" / (std::string(id) + ".ply"),
                    archive / "job" / (std::string(id) + ".ply"));
  }

  // The scan of another place.
  fs::path mini_scan() {
    if (!fs::exists(scratch / "mini")) write_mini_scene(scratch / "mini");
    return scratch / "mini" / "s.ply";
  }

  // "planes job/west.ply west" and the like, in the order of the plan.
  std::vector<std::string> planned(const std::string& profile = "", int exit_code = 0) {
    if (!profile.empty()) io::write_text(scratch / "p.toml", profile);
    const auto outcome =
        plan(archive, store, profile.empty() ? "" : "--profile " + (scratch / "p.toml").string());
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err << outcome.out;
    summary = json_of(outcome);
    std::vector<std::string> ids;
    const auto manifest = nlohmann::json::parse(io::read_text(store / "manifest.json"));
    for (const auto& unit : manifest["units"]) ids.push_back(unit["id"]);
    return ids;
  }

  nlohmann::json run_night(int exit_code = 0) {
    const auto ran = run_store(store);
    EXPECT_EQ(ran.exit_code, exit_code) << ran.err << ran.out;
    return json_of(ran);
  }

  nlohmann::json result_of(const std::string& result) {
    return nlohmann::json::parse(io::read_text(store / "results" / result / "summary.json"));
  }

  using Ids = std::vector<std::string>;
  Scratch scratch;
  fs::path archive = scratch / "archive", store = scratch / "store";
  nlohmann::json summary;
};

}  // namespace

TEST_F(LooseScans, of_a_folder_are_a_scene_unless_a_profile_says_otherwise) {
  fs::create_directories(archive / "alone");
  fs::copy_file(mini_scan(), archive / "alone/s.ply");
  ASSERT_EQ(run("hybrid convert " + mini_scan().string() + " " + (scratch / "one.pts").string() + " --quiet")
                .exit_code,
            0);
  const std::string one = io::read_text(scratch / "one.pts");
  io::write_text(archive / "alone-file/two.pts", one + one);  // two scans

  const Ids together = {"planes alone/s.ply s",
                        "planes alone-file/two.pts two-0",
                        "planes alone-file/two.pts two-1",
                        "planes job/east.ply east",
                        "planes job/west.ply west",
                        "scene alone-file/two.pts",
                        "scene job",
                        "report"};
  EXPECT_EQ(planned(), together);
  EXPECT_EQ(summary["units"]["scene"]["of_loose_scans"], 2);
  const auto dry = run("hybrid batch plan " + archive.string() + " --dry-run --out " + store.string());
  EXPECT_NE(dry.out.find("scene job: " + (archive / "job").string() + " (2 loose scan files)\n"),
            std::string::npos)
      << dry.out;
  EXPECT_NE(dry.out.find("2 of them loose scans that lie together"), std::string::npos) << dry.out;

  const Ids by_file = {"planes alone/s.ply s",
                       "planes alone-file/two.pts two-0",
                       "planes alone-file/two.pts two-1",
                       "planes job/east.ply east",
                       "planes job/west.ply west",
                       "scene alone-file/two.pts",
                       "report"};
  EXPECT_EQ(planned("[run]\ngroup = \"file\"\n"), by_file);
  const Ids none = {
      "planes alone/s.ply s",     "planes alone-file/two.pts two-0", "planes alone-file/two.pts two-1",
      "planes job/east.ply east", "planes job/west.ply west",        "report"};
  EXPECT_EQ(planned("[run]\ngroup = \"none\"\n"), none);
  EXPECT_EQ(planned("[run]\ngroup = \"none\"\n[[scene]]\nmatch = \"job\"\ngroup = \"folder\"\n").at(5),
            "scene job");
  EXPECT_TRUE(summary["notes"].empty()) << summary["notes"];
  io::write_text(scratch / "q.toml", "[run]\ngroup = \"all\"\n");
  const auto unknown = plan(archive, store, "--profile " + (scratch / "q.toml").string());
  EXPECT_EQ(unknown.exit_code, 4);
  EXPECT_NE(unknown.err.find("q.toml:2"), std::string::npos) << unknown.err;
  EXPECT_NE(unknown.err.find("auto"), std::string::npos) << unknown.err;
}

TEST_F(LooseScans, beside_a_scene_file_by_another_name_are_planned_with_a_note) {
  io::write_text(archive / "job/church.toml", "[[scan]]\nfile = \"west.ply\"\n");
  planned();
  EXPECT_NE(summary["notes"].dump().find("job/church.toml"), std::string::npos) << summary["notes"];
  EXPECT_NE(summary["notes"].dump().find("a scene file by another name"), std::string::npos)
      << summary["notes"];
}

TEST_F(LooseScans, of_a_folder_of_very_many_are_none) {
  fs::create_directories(archive / "many");
  for (int i = 10; i < 35; ++i) fs::copy_file(mini_scan(), archive / "many" / (std::to_string(i) + ".ply"));
  EXPECT_EQ(planned().size(), 2u + 25 + 1 + 1);
  ASSERT_EQ(summary["notes"].size(), 1u) << summary;
  EXPECT_EQ(summary["notes"][0]["path"], "many");
  EXPECT_NE(summary["notes"][0]["what"].get<std::string>().find("25 loose scans: more than 24"),
            std::string::npos);
  EXPECT_EQ(planned("[run]\ngroup = \"folder\"\n").size(), 2u + 25 + 2 + 1);
  EXPECT_TRUE(summary["notes"].empty()) << summary;
}

// What lies beside is of another place, or damaged: neither costs the scene anything.
TEST_F(LooseScans, are_registered_to_each_other_night_after_night) {
  planned();
  EXPECT_EQ(run_night()["computed"], 4);
  const auto alone =
      run("hybrid run " + (archive / "job").string() + " --out " + (scratch / "alone").string() + " --quiet");
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  std::string made = made_for(store, "job"), expected = content_list(scratch / "alone");
  for (const char* seal : {"object.json", "log.txt", "record.json"})
    if (const auto at = made.find(std::string(seal) + " "); at != std::string::npos)
      made.erase(at, made.find('\n', at) + 1 - at);
  EXPECT_EQ(made, expected);
  const auto first = result_of("job/scene");
  EXPECT_EQ(first["scene"], "job");
  EXPECT_EQ(first["scans"][1]["registration"]["status"], "accepted");
  EXPECT_EQ(first["scans"][1]["registration"]["how"], "neighbour");

  // First in the list, and of another place: it has planes and no pose, and nothing fails.
  fs::copy_file(mini_scan(), archive / "job/another.ply");
  planned();
  EXPECT_EQ(run_night()["computed"], 3);  // its planes, the scene, the report
  const auto second = result_of("job/scene");
  ASSERT_EQ(second["scans"].size(), 3u);
  EXPECT_EQ(second["scans"][0]["registration"]["status"], "abstained");
  EXPECT_NE(second["scans"][0]["registration"]["reason"].get<std::string>(), "");
  EXPECT_EQ(second["scans"][1]["registration"]["how"], "frame");
  EXPECT_EQ(second["scans"][2]["registration"]["status"], "accepted");
  EXPECT_TRUE(second["failures"].empty());
  EXPECT_EQ(run("hybrid batch diff " + store.string()).exit_code, 0);

  io::write_text(archive / "job/cut.ply", io::read_text(mini_scan()).substr(0, 60));
  planned("", 3);
  EXPECT_EQ(run_night(3)["computed"], 2);  // the scene, the report
  EXPECT_EQ(result_of("job/scene")["scans"].size(), 3u);
  EXPECT_EQ(result_of("job/scene")["failures"].size(), 1u);
  fs::remove(archive / "job/cut.ply");
  planned();
  EXPECT_EQ(run_night()["computed"], 0);
  EXPECT_EQ(result_of("job/scene"), second);
}

}  // namespace hybrid::e2e
