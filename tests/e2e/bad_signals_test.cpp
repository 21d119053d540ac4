// SIGTERM, SIGINT and SIGHUP in every stage: exit code 130, complete files stay, no other does. kill -9 in
// the middle of a write: the next run gives the same bytes and clears away what was left.
#include <gtest/gtest.h>

#include <csignal>

#include "bad_mini_scene.hpp"
#include "bad_output_check.hpp"
#include "io/output.hpp"
#include "traced_run.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

std::string run_mini(const fs::path& out) {
  return "run " + (mini_scene() / "scene.toml").string() + " --out " + out.string();
}

struct Interrupt {
  const char* name;
  int signal;
  Moment moment;
};

void PrintTo(const Interrupt& row, std::ostream* out) {
  *out << row.name;
}

class Interrupted : public ::testing::TestWithParam<Interrupt> {};

std::vector<Interrupt> interrupts() {
  std::vector<Interrupt> list;
  for (const auto& [name, prints] :
       std::vector<std::pair<const char*, const char*>>{{"read_scene", "scene mini: read"},
                                                        {"read_scan", "scan s: read"},
                                                        {"resample", "scan s: resample"},
                                                        {"square_planes", "scan s: square planes"},
                                                        {"superclusters", "scan s: superclusters"},
                                                        {"contours", "scan s: contours"},
                                                        {"decimate", "scan s: decimate"},
                                                        {"landmarks", "scan s: landmarks"},
                                                        {"icp", "scan s: ICP"},
                                                        {"residuals", "scan s: residuals"},
                                                        {"write", "scan s: write"},
                                                        {"render", "view front: render"},
                                                        {"leave_one_out", "view left-out: render"},
                                                        {"colour", "scan s: colour"},
                                                        {"report", "scene mini: report"}})
    list.push_back({name, SIGTERM, {prints, ""}});
  list.push_back({"sigint", SIGINT, {"scan s: contours", ""}});
  list.push_back({"sighup", SIGHUP, {"view front: render", ""}});
  // The last moment at which there is anything left to do.
  list.push_back({"before_the_last_file", SIGTERM, {"", "/timing.json"}});
  list.push_back({"in_the_middle_of_a_write", SIGTERM, {"", "/range.exr"}});
  return list;
}

}  // namespace

TEST_P(Interrupted, leaves_complete_files_only) {
  const Scratch scratch;
  const auto outcome = run_and_signal(run_mini(scratch / "out"), GetParam().moment, GetParam().signal);
  if (!outcome) GTEST_SKIP() << "this machine does not allow tracing";
  EXPECT_EQ(outcome->exit_code, 130) << outcome->err;
  EXPECT_NE(outcome->err.find("interrupted by SIG"), std::string::npos) << outcome->err;
  EXPECT_EQ(outcome->out, "");
  EXPECT_FALSE(fs::exists(scratch / "out/summary.json"));
  expect_complete_files(scratch / "out");
}

INSTANTIATE_TEST_SUITE_P(Stages, Interrupted, ::testing::ValuesIn(interrupts()),
                         [](const auto& row) { return std::string(row.param.name); });

class Killed : public ::testing::TestWithParam<const char*> {};

TEST_P(Killed, the_next_run_gives_the_same_bytes) {
  const Scratch scratch;
  const auto killed = run_and_signal(run_mini(scratch / "out") + " --quiet", {"", GetParam()}, SIGKILL);
  if (!killed) GTEST_SKIP() << "this machine does not allow tracing";
  EXPECT_EQ(killed->exit_code, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(scratch / "out" / GetParam()));
  const auto again = run("hybrid " + run_mini(scratch / "out") + " --quiet");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(content_list(scratch / "out"), content_list(mini_result()));
}

INSTANTIATE_TEST_SUITE_P(Writers, Killed,
                         ::testing::Values("scans/s/range.exr", "scans/s/detail.ply", "views/front.png",
                                           "report/index.html", "summary.json"),
                         [](const auto& row) {
                           std::string name = row.param;
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

TEST(Killed, an_old_summary_does_not_survive_a_run_that_did_not_end) {
  const Scratch scratch;
  fs::copy(mini_result(), scratch / "out", fs::copy_options::recursive);
  const auto outcome = run_and_signal(run_mini(scratch / "out"), {"view front: render", ""}, SIGTERM);
  if (!outcome) GTEST_SKIP() << "this machine does not allow tracing";
  EXPECT_EQ(outcome->exit_code, 130) << outcome->err;
  EXPECT_FALSE(fs::exists(scratch / "out/summary.json"));
  // The folder still knows whose it is.
  io::write_text(scratch / "other.toml", "[scene]\nname = \"other\"\n[model]\nfile = \"" +
                                             (mini_scene() / "proxy.obj").string() + "\"\n");
  const auto other =
      run("hybrid run " + (scratch / "other.toml").string() + " --out " + (scratch / "out").string());
  EXPECT_EQ(other.exit_code, 4);
  EXPECT_NE(other.err.find("holds the results of scene 'mini', not of scene 'other'"), std::string::npos)
      << other.err;
}

}  // namespace hybrid::e2e
