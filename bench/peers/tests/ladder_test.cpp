#include "compare/ladder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "compare/plot_svg.hpp"
#include "compare/table.hpp"

namespace hybrid::compare {
namespace {

// A program that takes `seconds_per_million` and notes every run in `log`.
Program fake(const std::string& name, bool ours, double seconds_per_million, std::string& log) {
  Program program;
  program.name = name;
  program.ours = ours;
  program.run = [=, &log](const Case& at) {
    log += name;
    Run run;
    run.seconds = run.wall_s = seconds_per_million * at.samples / 1e6;
    run.peak_mb = at.samples / 1e4;
    run.report = {{"package", "fake 1"}, {"settings", "a | b"}};
    return run;
  };
  program.score = [](const Case&, Row& row) { row.quality = "good"; };
  return program;
}

const Row& row_of(const std::vector<Row>& rows, const std::string& size, const std::string& program) {
  for (const Row& row : rows)
    if (row.size == size && row.program == program) return row;
  throw std::runtime_error("no such row");
}

struct Ladder : testing::Test {
  std::string log;
  LadderOptions options;
  Job job{"planes", {{"0.25 MP", 250e3, true}, {"1 MP", 1e6, false}, {"5 MP", 5e6, false}}, {}};
};

TEST_F(Ladder, TakesTurns) {
  job.cases = {{"1 MP", 1e6, false}};
  job.programs = {fake("A", true, 1, log), fake("B", false, 2, log), fake("C", false, 3, log)};
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(log, "ABCABCABC");
  EXPECT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1].runs.size(), 3u);
  EXPECT_EQ(rows[1].package, "fake 1");
}

TEST_F(Ladder, ExtrapolatesWhatWouldTakeTooLongUnlessAskedForAll) {
  job.programs = {fake("A", true, 1, log), fake("B", false, 20, log)};
  auto rows = run_ladder(job, options);
  const Row& guessed = row_of(rows, "5 MP", "B");
  EXPECT_EQ(guessed.outcome, Outcome::extrapolated);
  EXPECT_NEAR(guessed.runs.at(0).seconds, 100, 1e-9);
  EXPECT_EQ(guessed.reason, "from 1 MP");
  EXPECT_EQ(guessed.quality, "good at 1 MP");
  EXPECT_EQ(row_of(rows, "1 MP", "B").runs.size(), 1u);  // 20 s: over the limit for further rounds
  options.full = true;
  rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "5 MP", "B").outcome, Outcome::ran);
}

TEST_F(Ladder, OnlySlowProgramsRunTheProbe) {
  job.programs = {fake("A", true, 1, log), fake("B", false, 1, log), fake("C", false, 400, log)};
  job.programs[2].slow = true;
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(log.substr(0, 4), "ACAB");  // the probe is for ours, whose output others read, and for C
  EXPECT_EQ(row_of(rows, "1 MP", "C").outcome, Outcome::extrapolated);
  EXPECT_EQ(row_of(rows, "1 MP", "C").reason, "from 0.25 MP");
  EXPECT_THROW(row_of(rows, "0.25 MP", "C"), std::runtime_error);
}

TEST_F(Ladder, NeverRunsWhatDoesNotFitInMemory) {
  job.programs = {fake("A", true, 0.1, log), fake("B", false, 0.1, log)};
  options.memory_mb = 300;
  options.full = true;
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "5 MP", "B").outcome, Outcome::extrapolated);
  EXPECT_EQ(row_of(rows, "5 MP", "B").reason, "from 1 MP, would need 500 MB");
}

TEST_F(Ladder, ForetellsNothingOverMoreThanAThousandfold) {
  job.cases = {{"30", 30, false}, {"100 k", 100e3, false}, {"10 M", 10e6, false}};
  job.programs = {fake("A", true, 1, log), fake("B", false, 1e4, log)};
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "100 k", "B").outcome, Outcome::ran);
  EXPECT_EQ(row_of(rows, "10 M", "B").outcome, Outcome::extrapolated);
}

TEST_F(Ladder, SaysWhyAProgramDidNotRun) {
  job.programs = {fake("A", true, 0.1, log), fake("B", false, 0.1, log), fake("C", false, 0.1, log)};
  job.programs[1].missing = "PCL not installed";
  job.programs[2].run = [](const Case&) -> compare::Run { throw std::runtime_error("no\nmemory"); };
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "1 MP", "B").outcome, Outcome::not_run);
  const std::string table = markdown_table(rows);
  EXPECT_NE(table.find("| planes | 1 MP | B | not run: PCL not installed |"), std::string::npos) << table;
  EXPECT_NE(table.find("| planes | 1 MP | C | not run: failed: no memory |"), std::string::npos) << table;
}

TEST_F(Ladder, RepeatsOnlyWhatFitsTheTimeOfASize) {
  job.cases = {{"1 MP", 1e6}};
  job.programs = {fake("A", true, 3, log), fake("B", false, 3.4, log), fake("C", false, 16, log)};
  options.rounds = 5;
  run_ladder(job, options);
  EXPECT_EQ(log, "ABCABA");  // 3 x 3 s fit into 10 s, 3 x 3.4 do not
}

TEST_F(Ladder, RepeatsNothingOnceTheTimeOfAllIsUp) {
  job.cases = {{"1 MP", 1e6}};
  job.programs = {fake("A", true, 1, log), fake("B", false, 1, log)};
  options.repeats_end = std::chrono::steady_clock::now();
  EXPECT_EQ(run_ladder(job, options).at(1).outcome, Outcome::ran);
  EXPECT_EQ(log, "AB");
}

TEST_F(Ladder, AFailureIsNotTriedAgainAtALargerSize) {
  job.programs = {fake("A", true, 1, log), fake("B", false, 1, log)};
  job.programs[1].run = [&](const Case&) -> compare::Run {
    log += "B";
    throw std::runtime_error("crashed");
  };
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(std::count(log.begin(), log.end(), 'B'), 1);
  EXPECT_EQ(row_of(rows, "1 MP", "B").reason, "failed: crashed");
  EXPECT_EQ(row_of(rows, "5 MP", "B").reason, "failed at 1 MP: crashed");
}

TEST_F(Ladder, AFailureIsTriedAgainWhereSmallIsHard) {
  job.larger_is_harder = false;
  job.programs = {fake("A", true, 1, log), fake("B", false, 1, log)};
  const auto runs = job.programs[1].run;
  job.programs[1].run = [=](const Case& at) {
    if (at.samples < 2e6) throw std::runtime_error("crashed");
    return runs(at);
  };
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "1 MP", "B").reason, "failed: crashed");
  EXPECT_EQ(row_of(rows, "5 MP", "B").reason, "");
  EXPECT_FALSE(row_of(rows, "5 MP", "B").runs.empty());
}

TEST_F(Ladder, LargeSizesAreForThoseThatSaySo) {
  job.cases[2].large = true;
  job.programs = {fake("A", true, 0.1, log), fake("B", false, 0.1, log)};
  job.programs[0].large = true;
  auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "5 MP", "A").outcome, Outcome::ran);
  EXPECT_EQ(row_of(rows, "5 MP", "B").outcome, Outcome::extrapolated);
  options.full = true;
  rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "5 MP", "B").outcome, Outcome::ran);
}

TEST_F(Ladder, AnotherFigureOfARunNeedsNoRunOfItsOwn) {
  job.cases = {{"1 MP", 1e6}, {"5 MP", 5e6}};
  job.programs = {fake("A", true, 1, log), Program(), fake("B", false, 1, log)};
  job.programs[1].name = "half of A";
  job.programs[1].run_of = "A";
  job.programs[1].figure = [](compare::Run run) {
    run.seconds /= 2;
    return run;
  };
  options.rounds = 2;
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(log, "ABABABAB");
  EXPECT_EQ(row_of(rows, "5 MP", "half of A").seconds(), (std::vector<double>{2.5, 2.5}));
  job.programs[0].run = [](const Case&) -> compare::Run { throw std::runtime_error("crashed"); };
  EXPECT_EQ(row_of(run_ladder(job, options), "1 MP", "half of A").reason, "failed: crashed");
}

TEST_F(Ladder, ASizeWithoutAScanIsNotRun) {
  job.cases[1].missing = "no scan: the disk is full";
  job.programs = {fake("A", true, 1, log)};
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "1 MP", "A").reason, "no scan: the disk is full");
  EXPECT_EQ(row_of(rows, "5 MP", "A").outcome, Outcome::ran);
}

TEST_F(Ladder, AScoreThatFailsLeavesTheTimes) {
  job.programs = {fake("A", true, 1, log)};
  job.programs[0].score = [](const Case&, Row&) { throw std::runtime_error("no truth"); };
  const auto rows = run_ladder(job, options);
  EXPECT_EQ(row_of(rows, "1 MP", "A").outcome, Outcome::ran);
  EXPECT_EQ(row_of(rows, "1 MP", "A").quality, "not scored: no truth");
}

TEST_F(Ladder, TableGivesRatiosToOursAndMarksGuesses) {
  job.programs = {fake("A", true, 1, log), fake("B", false, 20, log)};
  const auto rows = run_ladder(job, options);
  const std::string table = markdown_table(rows);
  EXPECT_NE(
      table.find("| planes | 1 MP | **A** | 1.00 (1.00-1.00) | 3 | 1.00 | 1.00 x | 100 | good | a   b |"),
      std::string::npos)
      << table;
  EXPECT_NE(table.find("| planes | 1 MP | B | 20.0 | 1 | 0.0500 | 20.0 x | 100 | good | a   b |"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("| planes | 5 MP | B | ~100 | extrapolated from 1 MP | ~0.0500 | ~20.0 x | ~500 |"),
            std::string::npos)
      << table;
  const auto json = json_of(rows);
  EXPECT_EQ(json.at(3).at("outcome"), "extrapolated");
  EXPECT_EQ(json.at(0).at("runs").size(), 3u);
}

TEST(Plot, HasALinePerProgramAndHollowGuesses) {
  const Plot plot{"t < u",
                  "MP",
                  "s",
                  {{"ours", true, {{1, 0.1, false}, {5, 0.4, false}}},
                   {"peer", false, {{1, 3, false}, {5, 15, true}}},
                   {"none", false, {}}}};
  const std::string svg = svg_of(plot);
  EXPECT_NE(svg.find("t &lt; u"), std::string::npos);
  EXPECT_NE(svg.find("text-anchor=\"middle\">5</text>"), std::string::npos);
  EXPECT_NE(svg.find(">ours</text>"), std::string::npos);
  EXPECT_NE(svg.find(">peer</text>"), std::string::npos);
  EXPECT_EQ(svg.find(">none</text>"), std::string::npos);
  EXPECT_NE(svg.find("stroke-dasharray"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg_of({"t", "x", "y", {}}).find("nothing was measured"), std::string::npos);
}

}  // namespace
}  // namespace hybrid::compare
