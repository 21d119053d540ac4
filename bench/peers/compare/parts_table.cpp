// How long the parts of a chain take: the table of the end-to-end jobs.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "compare/statistics.hpp"
#include "compare/table.hpp"

namespace hybrid::compare {
namespace {

constexpr const char* kParts[] = {"read", "planes", "register", "decimate", "write"};

template <typename Figure>
double median_of(const Row& row, const Figure& figure) {
  std::vector<double> all;
  for (const Run& run : row.runs) all.push_back(figure(run));
  return median(all);
}

double part_s(const Run& run, const char* name) {
  const auto parts = run.report.find("parts");
  return parts == run.report.end() ? 0.0 : parts->value(name, 0.0);
}
// Of the process, what is in no part.
double rest_s(const Run& run) {
  double rest = run.wall_s;
  for (const char* name : kParts) rest -= part_s(run, name);
  return rest;
}
double wall_s(const Run& run) {
  return run.wall_s;
}
double cpu_s(const Run& run) {
  return run.cpu_s;
}
double peak_mb(const Row& row) {
  double most = 0;
  for (const Run& run : row.runs) most = std::max(most, run.peak_mb);
  return most;
}

std::string median_and_extremes(const Row& row) {
  const auto [least, most] = std::minmax_element(
      row.runs.begin(), row.runs.end(), [](const Run& a, const Run& b) { return a.wall_s < b.wall_s; });
  return fmt::format("{} ({}-{})", three_digits(median_of(row, wall_s)), three_digits(least->wall_s),
                     three_digits(most->wall_s));
}

// `ours`: the row that wall clock and processor time are compared with, or nullptr.
std::string line_of(const Row& row, const Row* ours) {
  std::string text =
      fmt::format("| {} | {} | {} |", row.job, row.size, row.ours ? "**" + row.program + "**" : row.program);
  if (row.outcome != Outcome::ran)
    return text + fmt::format(" {}: {} | | | | | | | | | | | | |\n",
                              row.outcome == Outcome::not_run ? "not run" : "not measured, extrapolated",
                              cell(row.reason));
  for (const char* name : kParts)
    text +=
        fmt::format(" {} |", three_digits(median_of(row, [&](const Run& run) { return part_s(run, name); })));
  const std::string ratios =
      ours ? fmt::format("{}, {}", ratio_text(median_of(row, wall_s), median_of(*ours, wall_s)),
                         ratio_text(median_of(row, cpu_s), median_of(*ours, cpu_s)))
           : "-";
  return text + fmt::format(" {} | {} | {} | {} | {} | {:.0f} | {} | {} |\n",
                            three_digits(median_of(row, rest_s)), median_and_extremes(row),
                            three_digits(median_of(row, cpu_s)), row.runs.size(), ratios, peak_mb(row),
                            cell(row.quality), cell(row.settings));
}

}  // namespace

std::string parts_table(const std::vector<Row>& rows) {
  std::map<std::pair<std::string, std::string>, const Row*> ours;
  for (const Row& row : rows)
    if (row.ours && row.outcome == Outcome::ran) ours.emplace(std::pair{row.job, row.size}, &row);
  std::string text =
      "| job | size | program | read | planes | register | decimate | write | rest | "
      "**wall, median (min-max)** | CPU | runs | times ours: wall, CPU | memory MB | quality | settings |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const auto found = ours.find({row.job, row.size});
    text += line_of(row, found == ours.end() ? nullptr : found->second);
  }
  return text;
}

}  // namespace hybrid::compare
