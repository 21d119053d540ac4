#include "archive/profile_bench.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "archive/child_program.hpp"
#include "archive/figures.hpp"
#include "archive/night.hpp"
#include "archive/outcome.hpp"
#include "archive/plan.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/output.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Per result and figure the mean over a scene's scans or views.
using SceneFigures = std::map<std::string, std::map<std::string, double>>;

struct ProfileResult {
  Json facts;
  SceneFigures scenes;
};

// Before the first night, which may take hours.
void check_profiles(const std::vector<fs::path>& profiles) {
  std::set<std::string> names;
  for (const auto& profile : profiles) {
    read_profile(profile);
    if (!names.insert(profile.stem().string()).second)
      fail(ErrorKind::usage, "--profiles: expected files of different names, found {} twice",
           profile.stem().string());
  }
}

// As a person would run it; what it says goes to our stderr.
void run_batch(const std::vector<std::string>& words) {
  std::vector<std::string> command = {own_program().string(), "batch"};
  command.insert(command.end(), words.begin(), words.end());
  const auto end = run_program(command, true);
  if (end.exit_code != 0 && end.exit_code != 3)
    throw Error(
        end.exit_code == 130  ? ErrorKind::interrupted
        : end.exit_code == 75 ? ErrorKind::temporary
        : end.exit_code == 4  ? ErrorKind::input
                              : ErrorKind::failed,
        fmt::format("hybrid batch {} ended with {}; its own words are above", words[0], end.exit_code));
}

void add_means(const Json& document, const std::string& prefix, std::map<std::string, double>& figures) {
  std::map<std::string, std::pair<double, int>> sums;
  for (const auto& [name, value] : figures_of(document)) {
    if (!value.is_number()) continue;
    auto& [sum, count] = sums[prefix + name.second];
    sum += value.get<double>();
    ++count;
  }
  for (const auto& [name, sum] : sums) figures[name] = sum.first / sum.second;
}

fs::path score_program() {
  const fs::path beside = own_program().parent_path() / "hybrid-score";
  std::error_code ignored;
  return fs::exists(beside, ignored) ? beside : fs::path("hybrid-score");
}

// Nothing without a truth; a score that cannot be made is said and left out.
Json score_of(const Unit& unit, const fs::path& object) {
  std::optional<fs::path> truth;
  try {
    truth = scene_of(unit).truth;
  } catch (const Error&) {
  }
  if (!truth) return nullptr;
  const auto end = run_program({score_program().string(), truth->string(), object.string(), "--json"});
  const Json score = Json::parse(end.out, nullptr, false);
  if (end.exit_code == 0 && score.is_object()) return score;
  log::warning("{}: not scored: {}", unit.id,
               end.exit_code == 127 ? "no hybrid-score beside this program or in PATH" : end.err);
  return nullptr;
}

void add_scene(const Store& store, const Unit& unit, const Outcome& outcome, ProfileResult& result) {
  const fs::path object = store.object(outcome.key);
  std::error_code ignored;
  if (!fs::exists(object / "summary.json", ignored)) return;
  auto& figures = result.scenes[unit.result];
  add_means(Json::parse(io::read_text(object / "summary.json")), "", figures);
  if (unit.kind != UnitKind::scene) return;
  const Json score = score_of(unit, object);
  if (score.is_null()) return;
  add_means({{"scans", score.value("scans", Json::array())}, {"views", score.value("views", Json::array())}},
            "score/", figures);
  result.facts["scored"] = result.facts["scored"].get<int>() + 1;
}

ProfileResult collect(const std::string& name, const fs::path& folder) {
  const Night night = open_night(folder.string());
  Outcomes outcomes(night.store, night.manifest);
  ProfileResult result;
  std::map<std::string, int> states;
  double cpu_s = 0, seconds = 0;
  std::uint64_t memory = 0;
  int failures = 0;
  result.facts = {{"name", name}, {"store", folder.string()}, {"scored", 0}};
  for (const Unit& unit : night.manifest.units) {
    const Outcome& outcome = outcomes.of(unit.index);
    ++states[name_of(outcome.state)];
    if (outcome.state != UnitState::done) ++failures;
    if (outcome.state != UnitState::done && outcome.state != UnitState::partial) continue;
    const Json record = night.store.record_json(outcome.key);
    cpu_s += record.value("cpu_s", 0.0);
    seconds += record.value("seconds", 0.0);
    memory = std::max(memory, record.value("memory_bytes", std::uint64_t{0}));
    if (!unit.result.empty() && unit.kind != UnitKind::report) add_scene(night.store, unit, outcome, result);
  }
  result.facts["units"] = states;
  result.facts["failures"] = failures;
  result.facts["cpu_s"] = cpu_s;
  result.facts["seconds"] = seconds;
  result.facts["peak_memory_bytes"] = memory;
  return result;
}

// Which end of a figure is the bad one cannot be known for all: both are given.
Json figure_rows(const std::vector<ProfileResult>& profiles) {
  std::set<std::string> names;
  for (const auto& [scene, figures] : profiles.front().scenes)
    for (const auto& [name, value] : figures) names.insert(name);
  Json rows = Json::array();
  for (const auto& name : names) {
    std::vector<double> sum(profiles.size(), 0), least(profiles.size(), INFINITY),
        most(profiles.size(), -INFINITY);
    int scenes = 0;
    for (const auto& [scene, ignored] : profiles.front().scenes) {
      std::vector<double> values;
      for (const auto& profile : profiles)
        if (const auto found = profile.scenes.find(scene); found != profile.scenes.end())
          if (const auto figure = found->second.find(name); figure != found->second.end())
            values.push_back(figure->second);
      if (values.size() != profiles.size()) continue;
      ++scenes;
      for (std::size_t i = 0; i < values.size(); ++i) {
        sum[i] += values[i];
        least[i] = std::min(least[i], values[i]);
        most[i] = std::max(most[i], values[i]);
      }
    }
    if (scenes == 0) continue;
    for (double& value : sum) value /= scenes;
    rows.push_back({{"name", name}, {"scenes", scenes}, {"mean", sum}, {"least", least}, {"most", most}});
  }
  return rows;
}

Json scene_rows(const std::vector<ProfileResult>& profiles) {
  std::map<std::pair<std::string, std::string>, Json> rows;
  for (std::size_t i = 0; i < profiles.size(); ++i)
    for (const auto& [scene, figures] : profiles[i].scenes)
      for (const auto& [name, value] : figures) {
        Json& values = rows[{scene, name}];
        if (values.is_null()) values = std::vector<Json>(profiles.size());
        values[i] = value;
      }
  Json list = Json::array();
  for (const auto& [name, values] : rows)
    list.push_back({{"result", name.first}, {"figure", name.second}, {"values", values}});
  return list;
}

}  // namespace

Json run_bench(const BenchRequest& request) {
  check_profiles(request.profiles);
  io::create_output_folder(request.out);
  std::vector<ProfileResult> results;
  for (const auto& profile : request.profiles) {
    const std::string name = profile.stem().string();
    const fs::path store = request.out / name;
    run_batch({"plan", request.archive.string(), "--out", store.string(), "--profile", profile.string()});
    std::vector<std::string> run = {"run", "--out", store.string()};
    run.insert(run.end(), request.run_options.begin(), request.run_options.end());
    run_batch(run);
    results.push_back(collect(name, store));
  }
  Json profiles = Json::array();
  for (const auto& result : results) profiles.push_back(result.facts);
  Json bench = {{"archive", request.archive.string()},
                {"profiles", profiles},
                {"figures", figure_rows(results)},
                {"scenes", scene_rows(results)}};
  io::write_text(request.out / "bench.json", json_text(bench) + "\n");
  return bench;
}

}  // namespace hybrid::archive
