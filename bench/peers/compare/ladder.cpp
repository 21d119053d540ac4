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
  std::string last_size, quality, failure;
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
  if (!too_long && !too_big && !(at.large && !program.large && !options.full)) return false;
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

// The rows of one size while its rounds go on.
struct Size {
  const Job& job;
  const Case& at;
  const LadderOptions& options;
  std::vector<History>& histories;
  std::vector<Row> rows = {};
  std::vector<bool> runs = {};
  std::vector<double> spent_s = {}, longest_s = {};

  void decide() {
    for (std::size_t p = 0; p < job.programs.size(); ++p) {
      const Program& program = job.programs[p];
      Row& row = rows.emplace_back(row_of(job, program, at));
      const std::string& missing = program.missing.empty() ? at.missing : program.missing;
      row.reason = missing.empty() ? histories[p].failure : missing;
      runs.push_back(row.reason.empty() && !(at.probe && !program.slow && !program.ours) &&
                     !extrapolated(program, at, histories[p], options, row));
      if (!row.reason.empty() && row.outcome == Outcome::ran) row.outcome = Outcome::not_run;
    }
    spent_s.assign(rows.size(), 0);
    longest_s.assign(rows.size(), 0);
  }

  bool again(std::size_t p) const {
    return spent_s[p] + longest_s[p] <= options.repeat_limit_s &&
           std::chrono::steady_clock::now() < options.repeats_end;
  }

  void fail(std::size_t p, const std::exception& problem) {
    rows[p].outcome = Outcome::not_run;
    rows[p].runs.clear();
    runs[p] = false;
    const bool faultless = dynamic_cast<const NoInput*>(&problem) != nullptr;
    rows[p].reason = (faultless ? "" : "failed: ") + std::string(problem.what());
    // Ours is tried again: the peers need what it writes.
    if (!faultless && !job.programs[p].ours && job.larger_is_harder)
      histories[p].failure = "failed at " + at.size + ": " + problem.what();
  }

  void take(std::size_t p, const Run& run) {
    rows[p].runs.push_back(run);
    take_report(run, rows[p]);
  }

  void run_once(std::size_t p) {
    const Program& program = job.programs[p];
    try {
      const Run run = program.run(at);
      spent_s[p] += run.wall_s;
      longest_s[p] = std::max(longest_s[p], run.wall_s);
      take(p, run);
      for (std::size_t q = p + 1; q < rows.size(); ++q)
        if (runs[q] && job.programs[q].run_of == program.name) take(q, job.programs[q].figure(run));
    } catch (const std::exception& problem) {
      fail(p, problem);
      for (std::size_t q = p + 1; q < rows.size(); ++q)
        if (runs[q] && job.programs[q].run_of == program.name) fail(q, problem);
    }
  }

  void finish() {
    for (std::size_t p = 0; p < rows.size(); ++p) {
      if (!runs[p] || rows[p].runs.empty()) continue;
      try {
        if (job.programs[p].score) job.programs[p].score(at, rows[p]);
      } catch (const std::exception& problem) {
        rows[p].quality = std::string("not scored: ") + problem.what();
      }
      remember(rows[p], at, histories[p]);
    }
  }
};

}  // namespace

std::vector<Row> run_ladder(const Job& job, const LadderOptions& options) {
  std::vector<History> histories(job.programs.size());
  std::vector<Row> table;
  for (const Case& at : job.cases) {
    Size size{job, at, options, histories};
    size.decide();
    for (int round = 0; round < (at.probe ? 1 : options.rounds); ++round)
      for (std::size_t p = 0; p < job.programs.size(); ++p) {
        if (!size.runs[p] || !job.programs[p].run || (round > 0 && !size.again(p))) continue;
        if (options.say)
          options.say(
              fmt::format("{}, {}, round {}: {}", job.name, at.size, round + 1, job.programs[p].name));
        size.run_once(p);
      }
    if (options.say && !at.probe) options.say(fmt::format("{}, {}: scoring", job.name, at.size));
    size.finish();
    if (!at.probe) table.insert(table.end(), size.rows.begin(), size.rows.end());
  }
  return table;
}

}  // namespace hybrid::compare
