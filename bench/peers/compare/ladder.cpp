#include "compare/ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "compare/statistics.hpp"

namespace hybrid::compare {
namespace {

// Start-up costs rule small sizes: nothing is foretold over more than a thousandfold.
constexpr double kFarthest = 1000;

// What is known of one program from the sizes it ran.
struct History {
  std::vector<Sized> seconds, process_s, memory_mb;
  std::string last_size, quality;
};

Row row_of(const Job& job, const Program& program, const Case& at) {
  Row row;
  row.job = job.name;
  row.size = at.size;
  row.program = program.name;
  row.ours = program.ours;
  row.samples = at.samples;
  return row;
}

// Whether the program is not run at this size but its figures are made up from smaller ones.
bool extrapolated(const Program& program, const Case& at, const History& history,
                  const LadderOptions& options, Row& row) {
  if (history.seconds.empty() || at.probe || at.samples > kFarthest * history.seconds.back().samples)
    return false;
  const double seconds = extrapolate(history.seconds, at.samples),
               memory = extrapolate(history.memory_mb, at.samples);
  const bool too_long = !program.ours && !options.full &&
                        std::max(seconds, extrapolate(history.process_s, at.samples)) > options.peer_limit_s;
  const bool too_big = options.memory_mb > 0 && memory > options.memory_mb;
  if (!too_long && !too_big) return false;
  row.outcome = Outcome::extrapolated;
  row.reason = fmt::format("from {}{}", history.last_size,
                           too_big ? fmt::format(", would need {:.0f} MB", memory) : std::string());
  row.quality = history.quality.empty() ? "" : history.quality + " at " + history.last_size;
  Run run;
  run.seconds = seconds;
  run.peak_mb = memory;
  row.runs = {run};
  return true;
}

void take_report(const Run& run, Row& row) {
  row.package = run.report.value("package", row.package);
  row.settings = run.report.value("settings", row.settings);
  row.samples = run.report.value("samples", row.samples);
}

void remember(const Row& row, const Case& at, History& history) {
  double memory = 0;
  std::vector<double> walls;
  for (const Run& run : row.runs) {
    memory = std::max(memory, run.peak_mb);
    walls.push_back(run.wall_s);
  }
  history.seconds.push_back({at.samples, median(row.seconds())});
  history.process_s.push_back({at.samples, median(walls)});
  history.memory_mb.push_back({at.samples, memory});
  history.last_size = at.size;
  history.quality = row.quality;
}

}  // namespace

std::vector<Row> run_ladder(const Job& job, const LadderOptions& options) {
  const auto say = [&](const std::string& text) {
    if (options.say) options.say(text);
  };
  std::vector<History> histories(job.programs.size());
  std::vector<Row> table;
  for (const Case& at : job.cases) {
    std::vector<Row> rows;
    std::vector<bool> runs(job.programs.size());
    for (std::size_t p = 0; p < job.programs.size(); ++p) {
      const Program& program = job.programs[p];
      rows.push_back(row_of(job, program, at));
      if (!program.missing.empty()) {
        rows[p].outcome = Outcome::not_run;
        rows[p].reason = program.missing;
      } else {
        runs[p] = !(at.probe && !program.slow && !program.ours) &&
                  !extrapolated(program, at, histories[p], options, rows[p]);
      }
    }
    std::vector<double> spent(job.programs.size(), 0);
    for (int round = 0; round < (at.probe ? 1 : options.rounds); ++round)
      for (std::size_t p = 0; p < job.programs.size(); ++p) {
        if (!runs[p] || (round > 0 && spent[p] > options.repeat_limit_s)) continue;
        say(fmt::format("{}, {}, round {}: {}", job.name, at.size, round + 1, job.programs[p].name));
        try {
          rows[p].runs.push_back(job.programs[p].run(at));
          spent[p] += rows[p].runs.back().wall_s;
          take_report(rows[p].runs.back(), rows[p]);
        } catch (const std::exception& problem) {
          rows[p].outcome = Outcome::not_run;
          rows[p].reason = std::string("failed: ") + problem.what();
          rows[p].runs.clear();
          runs[p] = false;
        }
      }
    for (std::size_t p = 0; p < job.programs.size(); ++p) {
      if (!runs[p] || rows[p].runs.empty()) continue;
      if (job.programs[p].score) job.programs[p].score(at, rows[p]);
      remember(rows[p], at, histories[p]);
    }
    if (!at.probe) table.insert(table.end(), rows.begin(), rows.end());
  }
  return table;
}

}  // namespace hybrid::compare
