#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>

#include "compare/plots.hpp"
#include "compare/results.hpp"
#include "compare/setup.hpp"
#include "compare/statistics.hpp"
#include "compare/table.hpp"

namespace hybrid::compare {
namespace {

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) parts.push_back(word);
  return parts;
}

double free_memory_mb() {
  std::ifstream input("/proc/meminfo");
  for (std::string key, line; input >> key; std::getline(input, line))
    if (key == "MemAvailable:") return std::stod(line) / 1024;
  return 0;
}

std::string now_text() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  return text;
}

// Not beside the others: it takes other scans and has a table of its own.
constexpr const char* kEndToEnd = "end-to-end";

std::vector<Row> run_all(Setup& setup, const std::string& only) {
  std::vector<Row> rows;
  const auto wanted = [&](const std::string& name) { return only.empty() || name == only; };
  const auto add = [&](const std::vector<Row>& more) { rows.insert(rows.end(), more.begin(), more.end()); };
  if (only == kEndToEnd)
    for (const Job& job : end_to_end_jobs(setup)) add(run_ladder(job, setup.ladder));
  if (wanted("planes")) add(run_ladder(planes_job(setup), setup.ladder));
  if (wanted("squares")) add(run_ladder(squares_job(setup), setup.ladder));
  if (wanted("icp"))
    for (const Job& job : icp_jobs(setup)) add(run_ladder(job, setup.ladder));
  if (wanted("rays")) add(ray_rows(setup));
  if (wanted("e57")) add(run_ladder(e57_job(setup), setup.ladder));
  return rows;
}

// A scan of each size; without one its rows say why.
std::string make_scenes(Setup& setup) {
  std::string made;
  std::vector<std::string> sizes = setup.sizes;
  sizes.insert(sizes.begin(), setup.probe_size);
  for (const auto& size : sizes) {
    if (!std::filesystem::exists(setup.scenes / ("room-" + size) / "scene.toml"))
      made += (made.empty() ? "" : ", ") + size;
    setup.ladder.say("scan of " + size + " MP");
    const auto failure = make_scene(setup, size);
    if (!failure.empty()) setup.no_scan[size] = failure;
  }
  return made.empty() ? "no scans" : made + " MP scans";
}

void write_results(const Setup& setup, const std::vector<Row>& rows, nlohmann::ordered_json machine,
                   bool end_to_end) {
  const std::string table = end_to_end ? parts_table(rows) : markdown_table(rows);
  const std::string name = end_to_end ? "end_to_end" : "compare";
  std::cout << table;
  machine["packages"] = packages_of(rows);
  const std::string text = results_heading(machine, rows) + table;
  write_text(setup.work / (name + ".md"), text);
  write_text(setup.work / (name + ".json"),
             nlohmann::ordered_json{{"machine", machine}, {"rows", json_of(rows)}}.dump(1) + "\n");
  const bool planes =
      std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.job == "planes"; });
  const std::string time = svg_of(plot_of(rows, PlotOf::seconds)),
                    memory = svg_of(plot_of(rows, PlotOf::memory));
  if (planes) {
    write_text(setup.work / "planes-time.svg", time);
    write_text(setup.work / "planes-memory.svg", memory);
  }
  if (setup.results.empty()) return;
  const std::string script = name + ".sh";
  replace_between_marks(setup.results, script,
                        text + without_rows(between_marks(setup.results, script), rows));
  if (planes) {
    write_text(setup.results.parent_path() / "peers" / "planes-time.svg", time);
    write_text(setup.results.parent_path() / "peers" / "planes-memory.svg", memory);
  }
}

int compare(Setup& setup, const std::string& sizes, const std::string& only, double minutes) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed_s = [=] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  setup.sizes = split(sizes);
  if (const char* folder = std::getenv("HYBRID_PEERS_DIR")) setup.external = folder;
  std::filesystem::create_directories(setup.work);
  setup.ladder.memory_mb = 0.85 * free_memory_mb();
  setup.ladder.say = [=](const std::string& text) {
    std::cerr << fmt::format("[{:5.0f} s] {}\n", elapsed_s(), text) << std::flush;
  };
  if (!setup.ladder.full)
    setup.ladder.repeats_end =
        start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(45 * minutes));
  auto machine = machine_json(setup);
  machine["date"] = now_text();
  const bool end_to_end = only == kEndToEnd;
  machine["scans_made"] = end_to_end ? "scans that were not there" : make_scenes(setup);
  const auto rows = run_all(setup, only);
  machine["minutes"] = std::round(elapsed_s() / 6) / 10;
  setup.ladder.say("done");
  write_results(setup, rows, machine, end_to_end);
  return 0;
}

}  // namespace
}  // namespace hybrid::compare

namespace {

// Sizes are also names of folders.
const CLI::Validator kSizes(
    [](const std::string& text) -> std::string {
      double last = 0;
      for (const auto& size : hybrid::compare::split(text)) {
        double value = 0;
        const auto [end, code] = std::from_chars(size.data(), size.data() + size.size(), value);
        if (code != std::errc() || end != size.data() + size.size() || !(value > last) || value > 400)
          return "expected ascending megapixels up to 400 like 1,5,20, found " + text;
        last = value;
      }
      return last > 0 ? "" : "expected megapixels like 1,5,20, found " + text;
    },
    "LIST");

}  // namespace

int main(int argc, char** argv) {
  using namespace hybrid::compare;
  CLI::App app{"Runs ours and every peer in turn on the same inputs; prints a Markdown table"};
  Setup setup;
  std::string sizes = "1", only;
  double minutes = 15;
  app.add_option("--bin", setup.bin, "folder of hybrid, hybrid-score and peers/")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--scenes", setup.scenes, "folder of room-1/, room-5/ ...; made where they are not there")
      ->required();
  app.add_option(
         "--work", setup.work,
         "folder for results, compare.md, compare.json and the plots (end-to-end: end_to_end.md, .json)")
      ->required();
  app.add_option("--sizes", sizes, "megapixels, ascending, with commas")
      ->check(kSizes)
      ->capture_default_str();
  app.add_option("--only", only, "one job")
      ->check(CLI::IsMember({"planes", "squares", "icp", "rays", "e57", kEndToEnd}));
  app.add_option("--rounds", setup.ladder.rounds, "runs of each program")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--threads", setup.threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  app.add_option("--minutes", minutes, "no repetitions after three quarters of this (--full: no such limit)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  auto* limit =
      app.add_option("--run-limit", setup.run_limit_s,
                     "seconds after which a peer is taken to hang and ended (--full: 4 hours); ours "
                     "twice that")
          ->check(CLI::PositiveNumber)
          ->capture_default_str();
  app.add_option("--e57", setup.e57, "scan for the E57 readers")->check(CLI::ExistingFile);
  app.add_option("--write-results", setup.results,
                 "RESULTS.md that gets the table, with its plots; what was not run this time stays there")
      ->check(CLI::ExistingFile);
  app.add_flag("--full", setup.ladder.full, "run what would take over a minute too");
  app.add_flag("--quick", setup.quick, "small sizes of registration and rays");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  if (setup.ladder.full && limit->count() == 0) setup.run_limit_s = 4 * 3600;
  try {
    return compare(setup, sizes, only, minutes);
  } catch (const std::exception& problem) {
    std::cerr << "error: " << problem.what() << "\n";
    return 1;
  }
}
