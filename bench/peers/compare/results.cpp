#include "compare/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace hybrid::compare {
namespace {

std::string text_of(const nlohmann::ordered_json& machine, const char* key) {
  if (!machine.contains(key)) return "not known";
  const auto& value = machine.at(key);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string device_of(const nlohmann::ordered_json& machine) {
  const auto list = machine.value("devices", nlohmann::ordered_json());
  if (!list.is_array() || list.empty() || !list.front().is_object()) return "OpenCL device not known";
  const auto& first = list.front();
  return fmt::format("{}, driver {}", first.value("name", "?"), first.value("driver", "?"));
}

// A file, and where the text between the marks is in it.
struct Marked {
  std::string whole;
  std::size_t from = 0, to = 0;
};

Marked read_marked(const std::filesystem::path& file, const std::string& script) {
  const std::string first = "<!-- " + script + ": begin -->\n", last = "<!-- " + script + ": end -->\n";
  std::ifstream input(file);
  std::stringstream content;
  content << input.rdbuf();
  if (!input) throw std::runtime_error(file.string() + ": cannot be read");
  std::string whole = content.str();
  const auto begin = whole.find(first), end = whole.find(last);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw std::runtime_error(fmt::format("{}: expected the lines {} and {}, found none or in another order",
                                         file.string(), first.substr(0, first.size() - 1),
                                         last.substr(0, last.size() - 1)));
  return {std::move(whole), begin + first.size(), end};
}

}  // namespace

std::vector<std::string> packages_of(const std::vector<Row>& rows) {
  std::set<std::string> packages;
  for (const Row& row : rows)
    if (!row.package.empty()) packages.insert(row.package);
  return {packages.begin(), packages.end()};
}

std::string results_heading(const nlohmann::ordered_json& machine, const std::vector<Row>& rows) {
  std::string packages;
  for (const auto& package : packages_of(rows)) packages += (packages.empty() ? "" : ", ") + package;
  return fmt::format(
      "`{}`, commit {}, {}; {} minutes after building, the making of {} included. {}, {} of {} cores, {} "
      "memory, load {} before; {}; {}. {}.\n\n",
      text_of(machine, "command"), text_of(machine, "commit"), text_of(machine, "date"),
      text_of(machine, "minutes"), text_of(machine, "scans_made"), text_of(machine, "processor"),
      text_of(machine, "threads"), text_of(machine, "cores"), text_of(machine, "memory"),
      text_of(machine, "load_before"), text_of(machine, "system"), device_of(machine), packages);
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path temporary = file.string() + ".tmp";
  std::ofstream output(temporary);
  output << text;
  output.close();
  std::error_code problem;
  if (output) std::filesystem::rename(temporary, file, problem);
  if (output && !problem) return;
  std::filesystem::remove(temporary, problem);
  throw std::runtime_error(file.string() + ": cannot be written; is the disk full?");
}

void replace_between_marks(const std::filesystem::path& file, const std::string& script,
                           const std::string& text) {
  Marked marked = read_marked(file, script);
  write_text(file, marked.whole.replace(marked.from, marked.to - marked.from, "\n" + text + "\n"));
}

std::string between_marks(const std::filesystem::path& file, const std::string& script) {
  const Marked marked = read_marked(file, script);
  return marked.whole.substr(marked.from, marked.to - marked.from);
}

std::string without_rows(const std::string& earlier, const std::vector<Row>& rows) {
  std::string kept, heading, table;  // of the table being read: what stands before its lines, and those
  bool in_table = false;
  const auto finish = [&] {
    if (!table.empty()) kept += heading + table + "\n";
    heading.clear();
    table.clear();
  };
  std::istringstream lines(earlier);
  for (std::string line; std::getline(lines, line);) {
    const bool cells = line.starts_with("|"), first = cells && !in_table;
    if (!cells && in_table) finish();
    in_table = cells;
    if (first || line.starts_with("|---") || (!cells && !(line.empty() && heading.empty())))
      heading += line + "\n";
    else if (cells && std::none_of(rows.begin(), rows.end(), [&](const Row& row) {
               return line.starts_with(fmt::format("| {} | {} |", row.job, row.size));
             }))
      table += line + "\n";
  }
  finish();
  if (kept.empty()) return kept;
  kept.pop_back();
  return fmt::format("\n{}", kept);
}

}  // namespace hybrid::compare
