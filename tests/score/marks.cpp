#include "marks.hpp"

#include <fnmatch.h>

#include "places.hpp"
#include "score/report/score_json.hpp"

namespace score_tests {

namespace fs = std::filesystem;

const fs::path& PerfectRoom::truth_file() {
  static const fs::path file = fs::path(HYBRID_E2E_DIR) / "room" / "truth.json";
  return file;
}

const score::SceneTruth& PerfectRoom::truth() {
  static const score::SceneTruth truth = score::read_scene_truth(truth_file());
  return truth;
}

const Results& PerfectRoom::perfect() {
  static const Results results = perfect_results(truth());
  return results;
}

const nlohmann::json& PerfectRoom::perfect_marks() {
  static const nlohmann::json marks = marks_of(perfect());
  return marks;
}

fs::path PerfectRoom::empty_folder() {
  const fs::path folder = fs::path(HYBRID_E2E_DIR) / "score";
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

fs::path PerfectRoom::write(const Results& results) {
  const fs::path folder = empty_folder();
  write_results(results, folder);
  return folder;
}

nlohmann::json PerfectRoom::marks_of(const fs::path& folder) {
  const score::ScoreOptions options;
  return score::scene_json(score::score_scene(truth_file(), folder, options), options);
}

void PerfectRoom::expect_others_hold(const nlohmann::json& marks, const std::vector<std::string>& patterns) {
  const nlohmann::json now = marks.flatten(), perfect = perfect_marks().flatten();
  for (const auto& [name, value] : perfect.items()) {
    const bool may_move =
        std::any_of(patterns.begin(), patterns.end(), [&, key = name](const std::string& pattern) {
          return fnmatch(pattern.c_str(), key.c_str(), 0) == 0;
        });
    if (may_move) continue;
    if (!now.contains(name))
      ADD_FAILURE() << name << " is gone";
    else if (value.is_number_float())
      EXPECT_NEAR(now[name].get<double>(), value.get<double>(), 1e-6) << name;
    else
      EXPECT_EQ(now[name], value) << name;
  }
}

}  // namespace score_tests
