// Damaged inputs: each is reported with its cause, the others come out as if it were not there.
#include <gtest/gtest.h>

#include <algorithm>

#include "../e2e/bad_mini_scene.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

std::string state_of(const nlohmann::json& status, const std::string& id) {
  for (const auto& row : status["list"])
    if (row["id"] == id) return row["state"];
  return "none";
}
std::string error_of(const nlohmann::json& status, const std::string& id) {
  for (const auto& row : status["list"])
    if (row["id"] == id) return row.value("error", "");
  return "none";
}

}  // namespace

TEST(ArchiveDamage, is_told_with_its_cause_and_the_others_go_on) {
  const FirstNight first;
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  write_small_archive(archive, 9);

  const std::string scan = io::read_text(archive / "b/s.ply");
  io::write_text(archive / "b/s.ply", scan.substr(0, scan.size() / 2));
  io::write_text(archive / "c/proxy.obj", "v 0 0\n");
  io::write_text(archive / "d/images/0.png", "no picture");
  fs::remove(archive / "e/s.ply");
  std::string broken = mini_scene_text();
  broken.replace(broken.find("\"proxy.obj\""), 11, "7");
  io::write_text(archive / "f/scene.toml", broken);
  io::write_png(archive / "g/images/0.png", Image8(32, 48, 3));
  std::string no_numbers = scan;
  std::fill(no_numbers.begin() + static_cast<std::ptrdiff_t>(scan.find("end_header\n") + 11),
            no_numbers.end(), '\xff');
  io::write_text(archive / "h/s.ply", no_numbers);
  fs::remove(archive / "i/s.ply");
  fs::create_directory(archive / "i/s.ply");
  ASSERT_EQ(run("hybrid convert " + (archive / "a/s.ply").string() + " " + (archive / "loose.e57").string())
                .exit_code,
            0);
  std::string pages = io::read_text(archive / "loose.e57");
  pages[5000] = static_cast<char>(pages[5000] ^ 1);
  io::write_text(archive / "loose.e57", pages);
  EXPECT_EQ(plan(archive, store).exit_code, 3);
  const auto ran = run_store(store);
  EXPECT_EQ(ran.exit_code, 3) << ran.err;

  const auto status = status_of(store);
  EXPECT_EQ(state_of(status, "planes b s"), "failed");
  EXPECT_NE(error_of(status, "planes b s").find("s.ply"), std::string::npos)
      << error_of(status, "planes b s");
  EXPECT_EQ(state_of(status, "scene b"), "partial");
  EXPECT_EQ(state_of(status, "planes c s"), "done");
  EXPECT_EQ(state_of(status, "scene c"), "failed");
  EXPECT_NE(error_of(status, "scene c").find("proxy.obj:1"), std::string::npos);
  EXPECT_EQ(state_of(status, "scene d"), "failed");
  EXPECT_NE(error_of(status, "scene d").find("0.png"), std::string::npos);
  EXPECT_EQ(state_of(status, "scene e"), "partial");
  EXPECT_NE(error_of(status, "scene e").find("no such file"), std::string::npos);
  EXPECT_EQ(state_of(status, "scene f"), "failed");
  EXPECT_NE(error_of(status, "scene f").find("scene.toml:12"), std::string::npos)
      << error_of(status, "scene f");
  EXPECT_EQ(state_of(status, "scene g"), "failed");
  EXPECT_NE(error_of(status, "scene g").find("0.png: expected the camera's 64 x 48 pixels, found 32 x 48"),
            std::string::npos)
      << error_of(status, "scene g");
  EXPECT_EQ(state_of(status, "scene h"), "partial");
  EXPECT_NE(error_of(status, "scene h").find("expected returns, found none among 7200 samples"),
            std::string::npos)
      << error_of(status, "scene h");
  EXPECT_EQ(state_of(status, "scene i"), "partial");
  EXPECT_NE(error_of(status, "scene i").find("expected a regular file, found a folder"), std::string::npos)
      << error_of(status, "scene i");
  EXPECT_EQ(state_of(status, "planes loose.e57 loose"), "failed");
  EXPECT_NE(error_of(status, "planes loose.e57 loose").find("(page 4): expected checksum"), std::string::npos)
      << status["list"];
  // The options of `hybrid run` that would help are a profile's here.
  EXPECT_NE(error_of(status, "planes loose.e57 loose").find("use salvage = true in [run] of a profile"),
            std::string::npos)
      << status["list"];
  EXPECT_EQ(status.dump().find("use --salvage"), std::string::npos) << status["list"];
  EXPECT_EQ(ran.out.find("use --salvage"), std::string::npos) << ran.out;
  EXPECT_EQ(made_for(store, "a"), made_for(first.store, "a"));
  for (const auto& row : status["list"])
    if (row["state"] == "failed") {
      EXPECT_NE(row["command"].get<std::string>().find("hybrid batch run --out"), std::string::npos);
      EXPECT_NE(io::read_text(store / row["log"].get<std::string>()).find("error"), std::string::npos);
    }

  // What `hybrid run` makes of the scene with the bad scan, words and all.
  const auto alone = run("hybrid run " + (archive / "b/scene.toml").string() + " --out " +
                         (scratch / "alone").string() + " --quiet");
  EXPECT_EQ(alone.exit_code, 4);
  EXPECT_EQ(io::read_text(store / "results/b/scene/summary.json"),
            io::read_text(scratch / "alone/summary.json"));

  // Nothing has changed: nothing is tried again, and it is still not well.
  EXPECT_EQ(plan(archive, store).exit_code, 3);
  const auto second = run_store(store);
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_EQ(json_of(second)["computed"], 0);

  // Mended: as clean as a store that never saw the damage.
  fs::remove(archive / "i/s.ply");
  fs::remove(archive / "loose.e57");
  write_small_archive(archive, 9);
  EXPECT_EQ(plan(archive, store).exit_code, 0);
  EXPECT_EQ(run_store(store).exit_code, 0);
  for (const char* scene : {"a", "b", "c"})
    EXPECT_EQ(made_for(store, scene), made_for(first.store, scene)) << scene;
}

TEST(ArchiveDamage, a_unit_that_takes_its_process_down_is_quarantined) {
  const Scratch scratch;
  const fs::path store = scratch / "store";
  write_small_archive(scratch / "archive", 1);
  ASSERT_EQ(plan(scratch / "archive", store).exit_code, 0);
  // Every worker dies at its first unit: three times the scan's, then the scene's, then the report's.
  const auto ran =
      run("HYBRID_FAIL_AT=unit-begun:1 hybrid batch run --out " + store.string() + " --jobs 1 --json");
  EXPECT_EQ(ran.exit_code, 1) << ran.err;
  auto status = status_of(store);
  EXPECT_EQ(state_of(status, "planes a s"), "quarantined");
  EXPECT_NE(error_of(status, "planes a s").find("signal 9"), std::string::npos);
  EXPECT_EQ(json_of(run_store(store))["computed"], 0);  // left alone
  const auto again = run_store(store, "--retry");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(state_of(status_of(store), "scene a"), "done");
}

TEST(ArchiveDamage, a_scene_without_a_model_is_told_a_command_that_it_can_be_run_by) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  write_small_archive(archive, 1);
  std::string text = mini_scene_text();
  text.resize(text.find("[model]"));
  io::write_text(archive / "a/scene.toml", text + "[[scan]]\nid = \"t\"\nfile = \"t.ply\"\n");
  ASSERT_EQ(plan(archive, store).exit_code, 3);
  EXPECT_EQ(run_store(store).exit_code, 3);
  const auto timing = nlohmann::json::parse(io::read_text(store / "results/a/scene/timing.json"));
  const std::string command = "hybrid run " + (archive / "a/scene.toml").string() + " --out ";
  EXPECT_EQ(timing["run_again"]["scan t"], command + "DIR");
  const auto again = run(command + (scratch / "again").string());
  EXPECT_EQ(again.exit_code, 3) << again.err;
  EXPECT_TRUE(fs::exists(scratch / "again/scans/s/planes.json"));
}

TEST(ArchiveDamage, limits_end_a_unit_and_not_the_run) {
  const Scratch scratch;
  const fs::path store = scratch / "store";
  write_small_archive(scratch / "archive", 1);
  ASSERT_EQ(plan(scratch / "archive", store).exit_code, 0);
  for (const std::string option : {"--memory", "--unit-memory"}) {  // the one to raise is named
    const auto memory = run_store(store, "--unit 0 " + option + " 1M");
    EXPECT_EQ(memory.exit_code, 1);
    EXPECT_NE(memory.out.find("took more than 1 MiB of memory, which is what " + option), std::string::npos)
        << memory.out;
  }
  // A small unit may be done before anybody looks at the clock.
  const auto time = run("HYBRID_FAIL_AT=unit-begun:1:pause hybrid batch run --out " + store.string() +
                        " --unit 0 --unit-time 0.001 --json");
  EXPECT_NE(time.out.find("took longer than 0.001 s (--unit-time); give it more"), std::string::npos)
      << time.out;
  EXPECT_EQ(run_store(store, "--retry").exit_code, 0);  // after three failures
}

// On a machine under load a process may be seen over the limit before it has been given its unit.
TEST(ArchiveDamage, a_limit_that_no_process_keeps_ends_the_run_on_slow_machines_too) {
  const Scratch scratch;
  const fs::path store = scratch / "store";
  write_small_archive(scratch / "archive", 1);
  ASSERT_EQ(plan(scratch / "archive", store).exit_code, 0);
  for (const std::string option : {"--memory", "--unit-memory"}) {
    const auto ran = run("HYBRID_FAIL_AT=worker-made:1:pause timeout 60 hybrid batch run --out " +
                         store.string() + " --unit 0 --json " + option + " 1M");
    EXPECT_EQ(ran.exit_code, 1) << ran.err;
    EXPECT_NE(ran.out.find("took more than 1 MiB of memory, which is what " + option), std::string::npos)
        << ran.out;
  }
}

}  // namespace hybrid::e2e
