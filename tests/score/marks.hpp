#pragma once
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "perfect_results.hpp"
#include "score/scene_score.hpp"

namespace score_tests {

// The tiny synthetic room, its perfect results and their marks, made once.
class PerfectRoom : public testing::Test {
 public:
  static const std::filesystem::path& truth_file();
  static const score::SceneTruth& truth();
  static const Results& perfect();
  static const nlohmann::json& perfect_marks();

  // Writes the results to an empty folder of this test.
  static std::filesystem::path write(const Results& results);
  static std::filesystem::path empty_folder();
  static nlohmann::json marks_of(const std::filesystem::path& folder);
  static nlohmann::json marks_of(const Results& results) { return marks_of(write(results)); }

  // Every figure whose name (as /a/0/b) matches none of the patterns is as in the perfect marks; `*` stands
  // for any part of a name.
  static void expect_others_hold(const nlohmann::json& marks, const std::vector<std::string>& patterns);
};

}  // namespace score_tests
