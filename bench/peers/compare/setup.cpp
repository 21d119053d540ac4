#include "compare/setup.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <thread>

#include "compare/process.hpp"

namespace hybrid::compare {
namespace {

constexpr double kLongestMaking_s = 1800;

std::string value_in(const std::string& file, const std::string& key) {
  std::ifstream input(file);
  for (std::string line; std::getline(input, line);)
    if (line.starts_with(key)) {
      const std::size_t start = line.find_first_not_of(" \t:", key.size());
      return start == std::string::npos ? "" : line.substr(start);
    }
  return "";
}

nlohmann::ordered_json devices_of(const Setup& setup) {
  try {
    return nlohmann::ordered_json::parse(
        run_process({(setup.bin / "hybrid").string(), "devices", "--json"}, 300).output);
  } catch (const std::exception& problem) {
    return std::string("not known: ") + problem.what();
  }
}

}  // namespace

std::string missing_peer(const Setup& setup, const std::string& program, const std::string& package) {
  return std::filesystem::exists(setup.bin / "peers" / program)
             ? ""
             : package + " not installed when this was built";
}

std::string missing_external(const Setup& setup, const std::string& program) {
  if (setup.external.empty()) return "HYBRID_PEERS_DIR not set";
  return std::filesystem::exists(setup.external / program) ? "" : "not in HYBRID_PEERS_DIR";
}

Run run_peer(const std::vector<std::string>& command, double limit_s) {
  const Finished finished = run_process(command, limit_s);
  if (const auto failure = failure_of(finished); !failure.empty()) throw std::runtime_error(failure);
  Run run;
  run.wall_s = finished.wall_s;
  run.cpu_s = finished.cpu_s;
  run.peak_mb = finished.peak_mb;
  try {
    run.report = nlohmann::json::parse(last_line(finished.output));
    run.seconds = run.report.at("seconds").get<double>();
  } catch (const nlohmann::json::exception& problem) {
    throw std::runtime_error("expected a JSON object with \"seconds\" as the last line of stdout: " +
                             std::string(problem.what()));
  }
  if (!(run.seconds > 0))
    throw std::runtime_error(fmt::format("expected seconds above 0, found {}", run.seconds));
  return run;
}

std::string make_scene(const Setup& setup, const std::string& size, const ScanRecipe& recipe) {
  const auto folder = setup.scenes / (recipe.folder + "-" + size);
  if (std::filesystem::exists(folder / "scene.toml")) return "";  // written last
  std::vector<std::string> command = {
      (setup.bin / "hybrid-synth").string(), recipe.scene, "--out", folder.string(), "--seed", "1"};
  const auto add = [&](const std::vector<std::string>& more) {
    command.insert(command.end(), more.begin(), more.end());
  };
  add({"--preset", "tiny", "--megapixels", size, "--only-scan", recipe.scan, "--quiet"});
  if (!recipe.format.empty()) add({"--format", recipe.format});
  try {
    std::filesystem::create_directories(setup.scenes);
    const auto failure = failure_of(run_process(command, kLongestMaking_s));
    return failure.empty() ? "" : "no scan: " + failure;
  } catch (const std::exception& problem) {
    return std::string("no scan: ") + problem.what();
  }
}

nlohmann::ordered_json machine_json(const Setup& setup) {
  utsname system{};
  uname(&system);
  const char* told = std::getenv("HYBRID_COMMAND");
  const char* commit = std::getenv("HYBRID_COMMIT");
  return {{"processor", value_in("/proc/cpuinfo", "model name")},
          {"cores", std::thread::hardware_concurrency()},
          {"threads", setup.threads ? setup.threads : static_cast<int>(std::thread::hardware_concurrency())},
          {"memory", value_in("/proc/meminfo", "MemTotal")},
          {"load_before", value_in("/proc/loadavg", "")},
          {"system", std::string(system.sysname) + " " + system.release},
          {"compiler", __VERSION__},
          {"devices", devices_of(setup)},
          {"command", told ? told : "hybrid-compare"},
          {"commit", commit ? commit : "not known"}};
}

}  // namespace hybrid::compare
