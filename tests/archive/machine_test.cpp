// A machine that gives out: no room, no permission, somebody else at work.
#include <gtest/gtest.h>
#include <unistd.h>

#include "../e2e/mounts.hpp"
#include "io/output.hpp"
#include "places.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

const std::string kPath = "PATH=" HYBRID_BIN_DIR ":$PATH; ";

}  // namespace

TEST(ArchiveMachine, a_full_disk_ends_the_run_and_the_store_stays_whole) {
  SKIP_WITHOUT_MOUNTS();
  const Scratch scratch;
  const fs::path archive = scratch / "archive", disk = scratch / "disk", clean = scratch / "clean";
  write_small_archive(archive, 1);
  ASSERT_EQ(plan(archive, clean).exit_code, 0);
  ASSERT_EQ(run_store(clean).exit_code, 0);
  fs::create_directories(disk);
  // Fills up at different places; then room is made, and the same store is gone on with.
  const std::string store = (disk / "store").string();
  const auto outcome = run_with_mounts(
      kPath + "mount -t tmpfs -o size=4m none " + disk.string() + "\nhybrid batch plan " + archive.string() +
      " --out " + store + " >/dev/null\nfor free in 24 96 400; do\n" + "  head -c $((4 << 20)) /dev/zero >" +
      disk.string() + "/filler 2>/dev/null\n" +
      "  head -c $((free << 10)) /dev/zero >/dev/null; truncate -s -${free}K " + disk.string() + "/filler\n" +
      "  hybrid batch run --out " + store + " --jobs 1 --retries 0 --quiet >/dev/null; echo code $?\n" +
      "  hybrid batch verify " + store + "; echo whole $?\ndone\nrm " + disk.string() +
      "/filler\nmount -o remount,size=64m " + disk.string() + "\nhybrid batch run --out " + store +
      " --jobs 1 --quiet >/dev/null; echo last $?\ncp -r " + store + " " + (scratch / "copy").string());
  EXPECT_EQ(outcome.out.find("whole 1"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("code 75"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_NE(outcome.err.find("the disk is full; free space and run again"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("last 0"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_EQ(results_of(scratch / "copy"), results_of(clean));
}

TEST(ArchiveMachine, a_read_only_store_is_said_and_can_be_looked_at) {
  SKIP_WITHOUT_MOUNTS();
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  write_small_archive(archive, 1);
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const auto outcome = run_with_mounts(
      kPath + "mount --bind " + store.string() + " " + store.string() + "\nmount -o remount,ro,bind " +
      store.string() + "\nhybrid batch run --out " + store.string() + "; echo run $?\nhybrid batch plan " +
      archive.string() + " --out " + store.string() + "; echo plan $?\nhybrid batch status " +
      store.string() + "; echo status $?\n");
  EXPECT_NE(outcome.out.find("run 1"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("plan 1"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("status 0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("lock: cannot write: Read-only file system"), std::string::npos) << outcome.err;
}

// A small archive and a store with its plan.
struct Planned {
  Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  explicit Planned(int scenes) {
    write_small_archive(archive, scenes);
    EXPECT_EQ(plan(archive, store).exit_code, 0);
  }
};

TEST(ArchiveMachine, the_second_of_two_runs_refuses_or_waits) {
  const Planned planned(2);
  const fs::path& store = planned.store;
  const std::string line = "hybrid batch run --out " + store.string() + " --jobs 1 --quiet";
  const auto outcome = run(line + " >/dev/null & pid=$!; while ! ls " + (store / "work").string() +
                           "/* >/dev/null 2>&1; do sleep 0.02; done; " + line + "; echo refused $?; " + line +
                           " --wait --json; echo waited $?; wait $pid; echo first $?");
  EXPECT_NE(outcome.out.find("refused 75"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_NE(outcome.err.find("in use by a run (process "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("waited 0"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("\"computed\": 0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("first 0"), std::string::npos) << outcome.out << outcome.err;
}

TEST(ArchiveMachine, single_units_run_side_by_side_and_say_what_they_need) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store", clean = scratch / "clean";
  write_small_archive(archive, 2);
  ASSERT_EQ(plan(archive, clean).exit_code, 0);
  ASSERT_EQ(run_store(clean).exit_code, 0);
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const auto early = run_store(store, "--unit 2");
  EXPECT_EQ(early.exit_code, 75);
  EXPECT_NE(early.err.find("unit 2 (scene a) needs unit 0 (planes a s)"), std::string::npos) << early.err;
  const std::string line = "hybrid batch run --out " + store.string() + " --jobs 1 --quiet >/dev/null";
  // Two tasks of an array for the same unit, another scheduler's next, then the rest by one task.
  const auto outcome =
      run("SLURM_ARRAY_TASK_ID=0 " + line + " & one=$!; " + line + " --unit 0 & two=$!; " +
          "JOB_COMPLETION_INDEX=1 " + line + "; echo $?; wait $one; echo $?; wait $two; echo $?; " + line +
          " --unit 2-3,4; echo $?; " + line + " --unit 2-3,4; echo $?");
  EXPECT_EQ(outcome.out, "0\n0\n0\n0\n0\n") << outcome.err;
  EXPECT_EQ(results_of(store), results_of(clean));
}

// Tasks of an array for the scans of two scenes that are one, and one more for the first: one of them makes
// it.
TEST(ArchiveMachine, of_equal_units_in_several_runs_one_is_made) {
  const Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
  write_small_archive(archive, 1);
  fs::copy(archive / "a", archive / "b", fs::copy_options::recursive);
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const std::string line = "hybrid batch run --out " + store.string() + " --jobs 1 --quiet --json --unit ";
  const auto outcome =
      run("(for unit in 0 1 0; do " + line + "$unit & done; wait) | grep -o 'computed.*' | sort");
  EXPECT_EQ(outcome.out, "computed\": 0,\ncomputed\": 0,\ncomputed\": 1,\n") << outcome.err;
  EXPECT_EQ(run_store(store, "--unit 0-1").exit_code, 0);
}

// What a run that is killed had locked is free at once.
TEST(ArchiveMachine, a_killed_run_leaves_no_unit_locked) {
  const Planned planned(1);
  const std::string line =
      "hybrid batch run --out " + planned.store.string() + " --jobs 1 --quiet --json --unit 0";
  const auto killed = run("HYBRID_FAIL_AT=unit-sent:1 " + line + " >/dev/null; echo $?");
  EXPECT_EQ(killed.out, "137\n") << killed.err;
  EXPECT_EQ(json_of(run(line))["computed"], 1);
}

}  // namespace hybrid::e2e
