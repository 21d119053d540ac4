#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "compare/plot_svg.hpp"
#include "compare/setup.hpp"
#include "compare/statistics.hpp"
#include "compare/table.hpp"

namespace hybrid::compare {
namespace {

double free_memory_mb() {
  std::ifstream input("/proc/meminfo");
  for (std::string key, line; input >> key; std::getline(input, line))
    if (key == "MemAvailable:") return std::stod(line) / 1024;
  return 0;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream output(file);
  output << text;
  output.close();
  if (!output) throw std::runtime_error(file.string() + ": cannot be written");
}

// Time, or memory, of the planes job against the size of the scan.
Plot plot_of(const std::vector<Row>& rows, bool memory) {
  Plot plot{memory ? "Plane extraction: peak memory" : "Plane extraction: from range image to labels",
            "megapixels",
            memory ? "MB" : "seconds",
            {}};
  std::map<std::string, std::size_t> lines;
  for (const Row& row : rows) {
    if (row.job != "planes" || row.outcome == Outcome::not_run) continue;
    const auto [found, added] = lines.emplace(row.program, plot.lines.size());
    if (added) plot.lines.push_back({row.program, row.ours, {}});
    const double value = memory ? row.runs.front().peak_mb : median(row.seconds());
    if (value > 0)
      plot.lines[found->second].points.push_back(
          {std::stod(row.size), value, row.outcome == Outcome::extrapolated});
  }
  return plot;
}

std::vector<Row> run_all(const Setup& setup, const std::string& only) {
  std::vector<Row> rows;
  const auto wanted = [&](const std::string& name) { return only.empty() || name == only; };
  const auto add = [&](const std::vector<Row>& more) { rows.insert(rows.end(), more.begin(), more.end()); };
  if (wanted("planes")) add(run_ladder(planes_job(setup), setup.ladder));
  if (wanted("squares")) add(run_ladder(squares_job(setup), setup.ladder));
  if (wanted("icp"))
    for (const Job& job : icp_jobs(setup)) add(run_ladder(job, setup.ladder));
  if (wanted("rays")) add(ray_rows(setup));
  return rows;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) parts.push_back(word);
  return parts;
}

int compare(Setup& setup, const std::string& sizes, const std::string& only) {
  setup.sizes = split(sizes);
  if (const char* folder = std::getenv("HYBRID_PEERS_DIR")) setup.external = folder;
  for (const auto& size : setup.sizes)
    if (!std::filesystem::exists(setup.scenes / ("room-" + size) / "truth.json"))
      throw std::runtime_error((setup.scenes / ("room-" + size)).string() +
                               ": expected a scene of hybrid-synth, found none; bench/compare.sh makes it");
  std::filesystem::create_directories(setup.work);
  setup.ladder.memory_mb = 0.85 * free_memory_mb();
  setup.ladder.say = [](const std::string& text) { std::cerr << text << std::endl; };
  const auto machine = machine_json(setup);
  const auto rows = run_all(setup, only);
  std::cout << markdown_table(rows);
  write_text(setup.work / "compare.md", markdown_table(rows));
  write_text(setup.work / "compare.json",
             nlohmann::ordered_json{{"machine", machine}, {"rows", json_of(rows)}}.dump(1) + "\n");
  if (std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.job == "planes"; })) {
    write_text(setup.work / "planes-time.svg", svg_of(plot_of(rows, false)));
    write_text(setup.work / "planes-memory.svg", svg_of(plot_of(rows, true)));
  }
  return 0;
}

}  // namespace
}  // namespace hybrid::compare

int main(int argc, char** argv) {
  using namespace hybrid::compare;
  CLI::App app{"Runs ours and every peer in turn on the same inputs; prints a Markdown table"};
  Setup setup;
  std::string sizes = "1", only;
  app.add_option("--bin", setup.bin, "folder of hybrid, hybrid-score and peers/")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--scenes", setup.scenes, "folder of room-1/, room-5/ ...")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--work", setup.work, "folder for results, compare.md, compare.json and the plots")
      ->required();
  app.add_option("--sizes", sizes, "megapixels, ascending, with commas")->capture_default_str();
  app.add_option("--only", only, "one job")->check(CLI::IsMember({"planes", "squares", "icp", "rays"}));
  app.add_option("--rounds", setup.ladder.rounds, "runs of each program")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--threads", setup.threads, "0 = all cores")->check(CLI::NonNegativeNumber);
  app.add_flag("--full", setup.ladder.full, "run what would take over a minute too");
  app.add_flag("--quick", setup.quick, "small sizes of registration and rays");
  CLI11_PARSE(app, argc, argv);
  try {
    return compare(setup, sizes, only);
  } catch (const std::exception& problem) {
    std::cerr << "error: " << problem.what() << "\n";
    return 1;
  }
}
