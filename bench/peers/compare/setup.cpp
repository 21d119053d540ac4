#include "compare/setup.hpp"

#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <thread>

#include "compare/process.hpp"

namespace hybrid::compare {
namespace {

constexpr double kLongestRun_s = 1800;

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const std::size_t before = text.find_last_of('\n', end);
  return text.substr(before == std::string::npos ? 0 : before + 1,
                     end - (before == std::string::npos ? 0 : before + 1) + 1);
}

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

Run run_peer(const std::vector<std::string>& command) {
  const Finished finished = run_process(command, kLongestRun_s);
  if (finished.stopped) throw std::runtime_error("stopped after half an hour");
  if (finished.exit_code != 0)
    throw std::runtime_error("exit status " + std::to_string(finished.exit_code) + ": " +
                             last_line(finished.errors));
  Run run;
  run.wall_s = finished.wall_s;
  run.peak_mb = finished.peak_mb;
  try {
    run.report = nlohmann::json::parse(last_line(finished.output));
    run.seconds = run.report.at("seconds").get<double>();
  } catch (const nlohmann::json::exception& problem) {
    throw std::runtime_error("expected a JSON object with \"seconds\" as the last line of stdout: " +
                             std::string(problem.what()));
  }
  return run;
}

nlohmann::ordered_json machine_json(const Setup& setup) {
  utsname system{};
  uname(&system);
  const char* commit = std::getenv("HYBRID_COMMIT");
  return {{"processor", value_in("/proc/cpuinfo", "model name")},
          {"cores", std::thread::hardware_concurrency()},
          {"threads", setup.threads ? setup.threads : static_cast<int>(std::thread::hardware_concurrency())},
          {"memory", value_in("/proc/meminfo", "MemTotal")},
          {"load_before", value_in("/proc/loadavg", "")},
          {"system", std::string(system.sysname) + " " + system.release},
          {"devices", devices_of(setup)},
          {"commit", commit ? commit : "not known"}};
}

}  // namespace hybrid::compare
