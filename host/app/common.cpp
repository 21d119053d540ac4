#include <charconv>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "core/parallel.hpp"

namespace hybrid::app {

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_option("--device", options.device, "cpu, gpu or an index of `hybrid devices`");
  command.add_option("--threads", options.threads, "host and CPU device threads, 0 = all cores");
  command.add_option("--seed", options.seed,
                     "seed of all random choices (default: the scene file's, else 1)");
  command.add_option("--tile", options.tile, "samples per tile side on the device; changes no result")
      ->check(CLI::Range(16, 65536));
  command.add_flag("--json", options.json, "print one JSON document on stdout");
  command.add_flag("--quiet", options.quiet, "no progress; warnings and errors only");
  command.add_flag("--dry-run", options.dry_run, "check the inputs, say what would be done, write nothing");
  command.add_flag("--force", options.force, "write into the output folder of another scene");
  command.add_option("--log-level", options.log_level, "debug, info, warning, error or off");
}

void add_salvage_option(CLI::App& command, bool& salvage) {
  command.add_flag("--salvage", salvage,
                   "use what is good of a damaged file and say what is lost, instead of failing");
}

void add_set_option(CLI::App& command, CommonOptions& options) {
  command
      .add_option(
          "--set", options.assignments,
          "SECTION.KEY=VALUE: an option of [planes], [register], [edit], [render] or [export], over the "
          "scene file's; repeatable")
      ->allow_extra_args(false);
}

void apply(const CommonOptions& options) {
  log::set_level(options.quiet && options.log_level == "info" ? "warning" : options.log_level);
  set_thread_count(options.threads);
}

bool shows_progress(const CommonOptions& options) {
  return !options.quiet && (options.log_level == "info" || options.log_level == "debug");
}

void print_dry_run(const CommonOptions& options, const batch::DryRun& tried) {
  for (const std::string& problem : tried.problems) log::error("{}", problem);
  if (options.json)
    std::cout << json_text(nlohmann::ordered_json{{"dry_run", tried.lines}, {"problems", tried.problems}})
              << "\n";
  else if (tried.exit_code != hybrid::exit_code(ErrorKind::input))
    for (const std::string& line : tried.lines) std::cout << line << "\n";
}

Vec3 parse_place(const std::string& text, const std::string& option) {
  Vec3 place;
  const char *at = text.data(), *end = text.data() + text.size();
  for (int axis = 0; axis < 3; ++axis) {
    const auto parsed = std::from_chars(at, end, place[axis]);
    const bool last = axis == 2;
    if (parsed.ec != std::errc() || !std::isfinite(place[axis]) ||
        (last ? parsed.ptr != end : parsed.ptr == end || *parsed.ptr != ','))
      fail(ErrorKind::usage, "{} {}: expected three numbers with commas between them, X,Y,Z", option, text);
    at = parsed.ptr + (last ? 0 : 1);
  }
  return place;
}

OptionValue parse_square(const std::string& text) {
  std::int64_t side = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), side);
  const bool number = parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
  if (number && side >= 3 && side <= 16) return side;
  if (text == "auto") return text;
  fail(ErrorKind::usage, "--square {}: expected auto or a number from 3 to 16", text);
}

std::uint64_t parse_bytes(const std::string& text, const std::string& option) {
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string unit(parsed.ptr, text.data() + text.size());
  const std::pair<const char*, double> units[] = {
      {"K", 1024.0}, {"M", 1048576.0}, {"G", 1073741824.0}, {"T", 1099511627776.0}};
  for (const auto& [letter, factor] : units)
    if (parsed.ec == std::errc() && value > 0 &&
        (unit == letter || unit == std::string(letter) + "B" || unit == std::string(letter) + "iB"))
      return static_cast<std::uint64_t>(value * factor);
  fail(ErrorKind::usage, "{} {}: expected a size such as 8G or 512M", option, text);
}

void add_memory_option(CLI::App& command, CommonOptions& options) {
  command.add_option("--memory", options.memory,
                     "such as 2G: large arrays go to files in the output folder that nobody sees and to the "
                     "system's file cache, where more would be held; changes no result");
}

std::unique_ptr<MemoryBudget> memory_budget(const CommonOptions& options, const std::filesystem::path& out) {
  if (options.memory.empty()) return nullptr;
  return std::make_unique<MemoryBudget>(parse_bytes(options.memory, "--memory"), out);
}

}  // namespace hybrid::app
