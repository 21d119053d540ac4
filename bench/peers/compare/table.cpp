#include "compare/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "compare/statistics.hpp"

namespace hybrid::compare {

std::string cell(std::string text) {
  for (char& c : text)
    if (c == '|' || c == '\n') c = ' ';
  return text;
}

namespace {

using Key = std::pair<std::string, std::string>;

// Median seconds of the first row of ours for each job and size: what the ratios are taken against.
std::map<Key, double> ours_seconds(const std::vector<Row>& rows) {
  std::map<Key, double> ours;
  for (const Row& row : rows)
    if (row.ours && row.outcome != Outcome::not_run)
      ours.emplace(Key{row.job, row.size}, median(row.seconds()));
  return ours;
}

double memory_mb(const Row& row) {
  double most = 0;
  for (const Run& run : row.runs) most = std::max(most, run.peak_mb);
  return most;
}

std::string seconds_text(const Row& row) {
  const auto all = row.seconds();
  if (row.outcome == Outcome::extrapolated) return fmt::format("~{}", three_digits(median(all)));
  if (all.size() == 1) return three_digits(all.front());
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return fmt::format("{} ({}-{})", three_digits(median(all)), three_digits(*least), three_digits(*most));
}

}  // namespace

std::string markdown_table(const std::vector<Row>& rows) {
  const auto ours = ours_seconds(rows);
  std::string text =
      "| job | size | program | seconds, median (min-max) | runs | million/s | times ours | memory MB | "
      "quality | "
      "settings |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const std::string name = row.ours ? fmt::format("**{}**", row.program) : row.program;
    if (row.outcome == Outcome::not_run) {
      text += fmt::format("| {} | {} | {} | not run: {} | | | | | | |\n", row.job, row.size, name,
                          cell(row.reason));
      continue;
    }
    const bool guess = row.outcome == Outcome::extrapolated;
    const double seconds = median(row.seconds()), memory = memory_mb(row);
    const auto found = ours.find({row.job, row.size});
    const char* mark = guess ? "~" : "";
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", row.job, row.size, name, seconds_text(row),
        guess ? fmt::format("extrapolated {}", row.reason) : std::to_string(row.runs.size()),
        seconds > 0 ? fmt::format("{}{}", mark, three_digits(row.samples / seconds / 1e6)) : "-",
        found == ours.end() ? "-" : fmt::format("{}{}", mark, ratio_text(seconds, found->second)),
        memory > 0 ? fmt::format("{}{:.0f}", mark, memory) : "", cell(row.quality), cell(row.settings));
  }
  return text;
}

nlohmann::ordered_json json_of(const std::vector<Row>& rows) {
  static const std::map<Outcome, std::string> kOutcomes = {
      {Outcome::ran, "ran"}, {Outcome::extrapolated, "extrapolated"}, {Outcome::not_run, "not run"}};
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    auto runs = nlohmann::ordered_json::array();
    for (const Run& run : row.runs)
      runs.push_back({{"seconds", run.seconds},
                      {"process_s", run.wall_s},
                      {"process_cpu_s", run.cpu_s},
                      {"peak_mb", run.peak_mb},
                      {"report", run.report}});
    list.push_back({{"job", row.job},
                    {"size", row.size},
                    {"samples", row.samples},
                    {"program", row.program},
                    {"ours", row.ours},
                    {"package", row.package},
                    {"settings", row.settings},
                    {"outcome", kOutcomes.at(row.outcome)},
                    {"reason", row.reason},
                    {"quality", row.quality},
                    {"score", row.score},
                    {"runs", runs}});
  }
  return list;
}

}  // namespace hybrid::compare
