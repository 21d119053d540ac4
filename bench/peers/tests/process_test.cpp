#include "compare/process.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "compare/setup.hpp"

namespace hybrid::compare {
namespace {

Finished shell(const std::string& script, double limit_s = 60) {
  return run_process({"/bin/sh", "-c", script}, limit_s);
}

Run peer(const std::string& script) {
  return run_peer({"/bin/sh", "-c", script}, 60);
}

TEST(Process, ReportsOutputMemoryAndFailure) {
  const auto finished = shell("echo out; echo first >&2; echo last >&2; exit 3");
  EXPECT_EQ(finished.output, "out\n");
  EXPECT_EQ(finished.errors, "first\nlast\n");
  EXPECT_EQ(finished.exit_code, 3);
  EXPECT_GT(finished.peak_mb, 0);
  EXPECT_EQ(failure_of(finished), "exit status 3: last");
  EXPECT_EQ(failure_of(shell("true")), "");
  EXPECT_THROW(run_process({"/no/such/program"}, 1), std::runtime_error);
}

TEST(Process, NamesTheSignalThatEndedAProgram) {
  const std::string crash = failure_of(shell("echo working >&2; kill -SEGV $$"));
  EXPECT_NE(crash.find("signal 11 (Segmentation fault)"), std::string::npos) << crash;
  EXPECT_NE(crash.find("working"), std::string::npos) << crash;
  const std::string killed = failure_of(shell("kill -KILL $$"));
  EXPECT_NE(killed.find("memory"), std::string::npos) << killed;
}

// A script's own child holds its pipes open: without the whole group the wait would last 20 s.
TEST(Process, EndsWhatHangsWithAllItHasStarted) {
  const auto slow = shell("sleep 20; echo late", 0.2);
  EXPECT_TRUE(slow.stopped);
  EXPECT_LT(slow.wall_s, 10);
  EXPECT_EQ(slow.output, "");
  EXPECT_EQ(failure_of(slow), "stopped after 0.2 s");
}

TEST(Process, APeersReportIsItsLastLine) {
  const auto run = peer(R"(echo chatter; echo '{"seconds": 1.5, "samples": 7}')");
  EXPECT_EQ(run.seconds, 1.5);
  EXPECT_EQ(run.report.at("samples"), 7);
  EXPECT_THROW(peer("echo nothing"), std::runtime_error);
  EXPECT_THROW(peer("echo '[1]'"), std::runtime_error);
  EXPECT_THROW(peer(R"(echo '{"seconds": 1}'; exit 1)"), std::runtime_error);
}

TEST(Process, AReportsSecondsAreATime) {
  for (const char* seconds : {"-1", "\"soon\"", "null", "0"})
    EXPECT_THROW(peer("echo '{\"seconds\": " + std::string(seconds) + "}'"), std::runtime_error) << seconds;
}

}  // namespace
}  // namespace hybrid::compare
