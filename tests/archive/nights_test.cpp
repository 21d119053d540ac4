// Night after night over one store: what is made, what is not made again.
#include <gtest/gtest.h>

#include "../e2e/bad_mini_scene.hpp"
#include "archive/manifest.hpp"
#include "archive/store.hpp"
#include "io/output.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

class Nights : public ::testing::Test, public FirstNight {
 protected:
  nlohmann::json next_night(const std::string& options = "") {
    const auto planned = plan(archive, store, options);
    EXPECT_EQ(planned.exit_code, 0) << planned.err;
    const auto ran = run_store(store);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json_of(ran);
  }
};

std::string without_seals(const std::string& list) {
  std::string kept;
  for (std::size_t at = 0; at < list.size();) {
    const auto end = list.find('\n', at) + 1;
    const std::string line = list.substr(at, end - at);
    if (!line.starts_with("object.json ") && !line.starts_with("record.json ") &&
        !line.starts_with("log.txt "))
      kept += line;
    at = end;
  }
  return kept;
}

}  // namespace

TEST_F(Nights, a_scene_is_what_run_writes) {
  const auto alone = run("hybrid run " + (archive / "a/scene.toml").string() + " --out " +
                         (scratch / "alone").string() + " --quiet");
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_EQ(without_seals(content_list(store / "results/a/scene/")), content_list(scratch / "alone"));
  EXPECT_TRUE(fs::exists(store / "results/report/archive.json"));
  const auto verified = run("hybrid batch verify " + store.string());
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
}

TEST_F(Nights, the_second_writes_nothing) {
  const auto before = stamps_of(store);
  EXPECT_EQ(next_night()["computed"], 0);
  auto after = stamps_of(store);
  for (const char* changed : {"lock"}) after[changed] = before.at(changed);  // who holds it
  for (const auto& [path, stamp] : before)
    if (path.starts_with("manifests/")) after[path] = stamp;  // its time says which plan is the latest
  EXPECT_EQ(after, before);
}

TEST_F(Nights, a_changed_scan_remakes_what_depends_on_it_alone) {
  change_scan(archive / "b");
  EXPECT_EQ(next_night()["computed"], 3);  // planes b, scene b, the report
  const auto& text = io::read_text(archive / "c/scene.toml");
  io::write_text(archive / "c/scene.toml",
                 text + "\n[[view]]\nname = \"more\"\neye = [1, 1, 1]\ntarget = [2, 2, 1]\nsize = [8, 8]\n");
  EXPECT_EQ(next_night()["computed"], 2);  // scene c, the report
  EXPECT_TRUE(fs::exists(store / "results/c/scene/views/more.png"));
}

TEST_F(Nights, a_profile_overrides_and_a_scene_of_it_overrides_that) {
  io::write_text(scratch / "p.toml",
                 "[render]\nblend = \"nearest\"\n[[scene]]\nmatch = \"b\"\nrender.blend = \"dual\"\n");
  EXPECT_EQ(next_night("--profile " + (scratch / "p.toml").string())["computed"], 4);  // no planes
  const auto blend = [&](const char* scene) {
    return nlohmann::json::parse(
        io::read_text(store / "results" / scene / "scene/summary.json"))["options"]["render"]["blend"];
  };
  EXPECT_EQ(blend("a"), "nearest");
  EXPECT_EQ(blend("b"), "dual");
  EXPECT_EQ(next_night()["computed"], 0);  // back to what was there
  EXPECT_EQ(blend("a"), "linear");
}

TEST_F(Nights, a_profile_exports_where_no_scene_file_asks_for_it) {
  io::write_text(scratch / "p.toml", "[[scene]]\nmatch = \"b\"\nexport.formats = \"ply\"\n");
  EXPECT_EQ(next_night("--profile " + (scratch / "p.toml").string())["computed"], 2);  // scene b, the report
  EXPECT_TRUE(fs::exists(store / "results/b/scene/export/points.ply"));
  EXPECT_FALSE(fs::exists(store / "results/a/scene/export"));
  io::write_text(scratch / "p.toml", "[[scene]]\nmatch = \"a\"\nexport.formats = \"all\"\n");  // the default
  EXPECT_EQ(next_night("--profile " + (scratch / "p.toml").string())["computed"], 2);
  EXPECT_TRUE(fs::exists(store / "results/a/scene/export/scene.glb"));
}

TEST_F(Nights, what_is_the_same_is_made_once_though_several_units_are_in_flight) {
  for (const char* copy : {"d", "e", "f"}) {
    fs::copy(archive / "a", archive / copy, fs::copy_options::recursive);
    change_scan(archive / copy);
  }
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const auto ran = run("hybrid batch run --json --jobs 3 --out " + store.string());
  EXPECT_EQ(json_of(ran)["computed"], 3) << ran.err;  // planes and scene of all three, the report
  EXPECT_EQ(json_of(ran)["units"]["done"], 13);
  EXPECT_EQ(fs::canonical(store / "results/d/scene"), fs::canonical(store / "results/f/scene"));
}

TEST_F(Nights, a_touched_file_is_not_made_again_and_a_forged_time_is_found) {
  const fs::path scan = archive / "a/s.ply";
  fs::last_write_time(scan, fs::file_time_type::clock::now());
  EXPECT_EQ(next_night()["computed"], 0);
  const auto time = fs::last_write_time(scan);
  {  // in place: the same inode
    std::string bytes = io::read_text(scan);
    FILE* file = std::fopen(scan.c_str(), "r+b");
    std::fseek(file, -2402, SEEK_END);
    std::fputc(bytes[bytes.size() - 2402] ^ 1, file);
    std::fclose(file);
  }
  fs::last_write_time(scan, time);
  EXPECT_EQ(next_night()["computed"], 0);
  EXPECT_EQ(next_night("--verify")["computed"], 3);
}

TEST_F(Nights, verify_finds_a_flipped_bit_and_the_next_run_mends_it) {
  const auto clean = results_of(store);
  const fs::path victim = fs::canonical(store / "results/a/scene/summary.json");
  std::string text = io::read_text(victim);
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 4);
  io::write_text(victim, text);
  const auto found = run("hybrid batch verify --json " + store.string());
  EXPECT_EQ(found.exit_code, 1);
  ASSERT_EQ(json_of(found)["damaged"].size(), 1u) << found.out;
  EXPECT_NE(found.out.find("summary.json"), std::string::npos);
  EXPECT_EQ(run("hybrid batch verify --remove " + store.string()).exit_code, 1);
  EXPECT_EQ(json_of(run_store(store))["computed"], 1);
  EXPECT_EQ(results_of(store), clean);
}

TEST_F(Nights, prune_keeps_what_a_plan_names) {
  EXPECT_EQ(json_of(run("hybrid batch prune --json " + store.string()))["removed"], 0);
  change_scan(archive / "a");
  EXPECT_EQ(next_night()["computed"], 3);
  EXPECT_EQ(json_of(run("hybrid batch prune --json " + store.string()))["removed"], 0);  // the older plan's
  const auto pruned = json_of(run("hybrid batch prune --keep 1 --json " + store.string()));
  EXPECT_EQ(pruned["removed"], 3);
  EXPECT_EQ(pruned["kept"], 7);
  EXPECT_EQ(run("hybrid batch verify " + store.string()).exit_code, 0);
  EXPECT_EQ(next_night()["computed"], 0);
}

TEST_F(Nights, an_archive_that_is_not_mounted_gets_no_plan) {
  fs::rename(archive, scratch / "elsewhere");
  fs::create_directories(archive / "lost+found");
  const auto before = stamps_of(store);
  const auto planned = plan(archive, store);
  EXPECT_EQ(planned.exit_code, 4) << planned.out;
  const std::string expected =
      archive.string() + ": expected scenes (scene.toml, *.scene.toml) or scans (.e57,";
  EXPECT_NE(planned.err.find(expected), std::string::npos) << planned.err;
  auto after = stamps_of(store);
  after["lock"] = before.at("lock");  // who holds it
  EXPECT_EQ(after, before);
  EXPECT_EQ(plan(archive, scratch / "other").exit_code, 4);
  EXPECT_FALSE(fs::exists(scratch / "other"));
}

TEST_F(Nights, a_plan_that_lost_most_of_the_last_says_so_once) {
  fs::rename(archive / "b", scratch / "b");
  EXPECT_EQ(plan(archive, store, "--dry-run").exit_code, 0);  // a third of it
  fs::rename(archive / "c", scratch / "c");
  const auto planned = plan(archive, store);
  EXPECT_EQ(planned.exit_code, 3) << planned.err;
  EXPECT_NE(planned.err.find("4 of the 6 scenes and scans of the store's last plan are gone (planes b s, "),
            std::string::npos)
      << planned.err;
  EXPECT_EQ(json_of(planned)["gone"]["units"].size(), 4u);
  EXPECT_EQ(plan(archive, store).exit_code, 0);
}

TEST_F(Nights, prune_does_not_count_a_plan_without_units) {
  archive::Manifest none;  // as earlier programs wrote it for a share that was not mounted
  none.archive = archive;
  const std::string text = archive::to_text(none);
  io::write_text(store / "manifests" / (archive::hash_of(text) + ".json"), text);
  io::write_text(store / "manifest.json", text);
  EXPECT_EQ(json_of(run("hybrid batch prune --keep 1 --dry-run --json " + store.string()))["removed"], 0);
  const auto ran = run_store(store);
  EXPECT_EQ(ran.exit_code, 4);
  EXPECT_NE(ran.err.find("manifest.json: the plan has no units"), std::string::npos) << ran.err;
  EXPECT_EQ(next_night()["computed"], 0);
}

}  // namespace hybrid::e2e
