// Power cuts at every named place: the next run goes on, nothing is lost but what was in flight, and the end
// is byte for byte that of a run nobody disturbed.
#include <gtest/gtest.h>

#include <csignal>

#include "io/output.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// In a session of its own, so that the whole group can die.
Outcome killed(const std::string& point, const std::string& arguments) {
  return run("HYBRID_FAIL_AT=" + point + ":group setsid --wait hybrid batch " + arguments + " --quiet");
}

// Whole ones: a folder without its seal would not be one.
std::ptrdiff_t objects_of(const fs::path& store) {
  std::ptrdiff_t count = 0;
  if (!fs::exists(store / "objects")) return 0;
  for (const auto& entry : fs::recursive_directory_iterator(store / "objects"))
    count += entry.path().filename() == "object.json";
  return count;
}

}  // namespace

TEST(ArchiveKills, resume_to_the_same_bytes) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store", clean = scratch / "clean";
  write_small_archive(archive, 2);
  ASSERT_EQ(plan(archive, clean).exit_code, 0);
  ASSERT_EQ(run_store(clean).exit_code, 0);

  const std::string plan_line = "plan " + archive.string() + " --out " + store.string();
  const std::string run_line = "run --out " + store.string() + " --jobs 1 --threads 2";
  for (const char* point : {"cache-written:1", "manifest-written:1"}) {
    EXPECT_EQ(killed(point, plan_line).exit_code, 128 + SIGKILL) << point;
  }
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  EXPECT_EQ(io::read_text(store / "manifest.json"), io::read_text(clean / "manifest.json"));

  std::ptrdiff_t made = 0;
  for (const char* point :
       {"object-begun:1", "unit-sent:1", "unit-begun:1", "object-made:1", "object-sealed:1", "object-named:1",
        "object-committed:1", "result-linked:1", "unit-begun:1"}) {
    EXPECT_EQ(killed(point, run_line).exit_code, 128 + SIGKILL) << point;
    const auto objects = objects_of(store);
    EXPECT_GE(objects, made) << point;
    made = objects;
  }
  EXPECT_EQ(made, 3);  // all but the second scene and the report
  const auto verified = run("hybrid batch verify " + store.string());
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  const auto rest = run_store(store);
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(json_of(rest)["computed"], 5 - made);  // only what was not there
  EXPECT_EQ(results_of(store), results_of(clean));
  EXPECT_TRUE(fs::is_empty(store / "work"));
}

TEST(ArchiveKills, a_worker_that_dies_is_replaced) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  write_small_archive(archive, 2);
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  // Each worker dies at its second unit, which the next one makes first.
  const auto ran =
      run("HYBRID_FAIL_AT=unit-begun:2 hybrid batch run --out " + store.string() + " --jobs 1 --json");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_NE(ran.err.find("ended by signal 9"), std::string::npos) << ran.err;
  EXPECT_EQ(json_of(ran)["units"]["done"], 5);
}

TEST(ArchiveKills, a_signal_ends_a_run_cleanly) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  write_small_archive(archive, 2);
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const auto ended = run("hybrid batch run --out " + store.string() +
                         " --jobs 1 --quiet & pid=$!; while ! ls " + (store / "work").string() +
                         "/*/log.txt >/dev/null 2>&1; do sleep 0.02; done; kill -TERM $pid; wait $pid");
  EXPECT_EQ(ended.exit_code, 130) << ended.err;
  EXPECT_TRUE(fs::is_empty(store / "work"));
  EXPECT_EQ(status_of(store)["units"]["planes"]["waiting"], 2);
  EXPECT_EQ(run_store(store).exit_code, 0);
}

}  // namespace hybrid::e2e
