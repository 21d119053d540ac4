#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "marks.hpp"
#include "places.hpp"
#include "score/error.hpp"

namespace score_tests {
namespace {

namespace fs = std::filesystem;

// Scoring throws an InputError that holds all the words.
void expect_refused(const fs::path& truth, const fs::path& results, const std::vector<std::string>& words) {
  try {
    score::score_scene(truth, results, {});
    ADD_FAILURE() << "expected an error about " << words[0];
  } catch (const score::InputError& problem) {
    for (const auto& word : words)
      EXPECT_NE(std::string(problem.what()).find(word), std::string::npos) << problem.what();
  }
}

// A copy of the truth's folder that may be damaged.
fs::path copied_truth() {
  const fs::path copy = fs::path(HYBRID_E2E_DIR) / "score-truth";
  fs::remove_all(copy);
  fs::copy(PerfectRoom::truth_file().parent_path(), copy, fs::copy_options::recursive);
  return copy;
}

Results one_scan() {
  Results results;
  results.scans = {PerfectRoom::perfect().scans[0]};
  return results;
}

void truncate(const fs::path& file) {
  fs::resize_file(file, fs::file_size(file) / 2);
}

int run(const std::string& arguments) {
  const std::string command = std::string(HYBRID_BIN_DIR) + "/hybrid-score " + arguments + " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_F(PerfectRoom, a_missing_part_of_the_truth_is_named) {
  const auto results = write(perfect());
  const fs::path truth = copied_truth();
  for (const char* part : {"truth/west.exr", "truth/views/novel-2.png", "detail.ply"}) {
    fs::rename(truth / part, truth / "aside");
    expect_refused(truth / "truth.json", results, {part, "expected a file, found none"});
    fs::rename(truth / "aside", truth / part);
  }
  std::ofstream(truth / "truth.json") << R"({"seed": 1, "preset": "tiny"})";
  expect_refused(truth / "truth.json", results, {"truth.json", "scans", "hybrid-synth"});
  std::ofstream(truth / "truth.json") << "not JSON";
  expect_refused(truth / "truth.json", results, {"truth.json", "expected JSON"});
  fs::remove_all(truth);
}

TEST_F(PerfectRoom, a_folder_without_results_is_refused) {
  const auto folder = empty_folder();
  expect_refused(truth_file(), folder, {folder.string(), "range.exr", "hybrid run"});
  expect_refused(truth_file(), folder / "nowhere", {"nowhere", "found nothing"});
}

TEST_F(PerfectRoom, damaged_images_are_named) {
  for (const char* file : {"scans/west/range.exr", "scans/west/labels.exr", "views/novel-2.exr"}) {
    const auto folder = write(perfect());
    truncate(folder / file);
    expect_refused(truth_file(), folder, {file, "write it again"});
  }
  const auto folder = write(one_scan());
  std::ofstream(folder / "scans/west/labels.exr") << "no image";
  expect_refused(truth_file(), folder, {"labels.exr", "OpenEXR"});
  truncate(folder / "scans/west/detail.ply");
}

TEST_F(PerfectRoom, results_of_another_seed_are_refused) {
  Results results = one_scan();
  for (float& range : results.scans[0].range_m) range += 1;
  expect_refused(truth_file(), write(results), {"range.exr", "another scene's or seed's", "truth.json"});

  results = one_scan();
  for (auto& source : results.scans[0].grid.source)
    if (source == 5) source = 5000000;
  expect_refused(truth_file(), write(results), {"range.exr", "another scene's or seed's"});
}

TEST_F(PerfectRoom, parts_of_different_runs_are_refused) {
  Results results = one_scan();
  auto folder = write(results);
  auto grid = results.scans[0].grid;
  grid.rows /= 2;
  write_labels_exr(folder / "scans/west/labels.exr", grid);
  expect_refused(truth_file(), folder, {"labels.exr", "one run"});

  for (auto& point : results.scans[0].kept) point.x() += 1;
  expect_refused(truth_file(), write(results), {"detail.ply", "one run"});

  results = one_scan();
  results.scans[0].status = "perhaps";
  expect_refused(truth_file(), write(results), {"pose.json", "accepted or abstained", "perhaps"});

  results = one_scan();
  results.scans[0].world_from_scan.rotation.col(0) *= -1;
  expect_refused(truth_file(), write(results), {"pose.json", "mirrored"});

  results = perfect();
  results.scans.clear();
  results.views[0].image.best.assign(results.views[0].image.best.size(), 6);
  expect_refused(truth_file(), write(results), {"both-textured.exr", "from 0 to 5", "found 6"});
}

TEST_F(PerfectRoom, the_programs_exit_codes) {
  const auto folder = write(one_scan());
  const std::string truth = truth_file().string(), results = folder.string();
  EXPECT_EQ(run(truth + " " + results), 0);
  EXPECT_EQ(run(truth + " " + results + " --json --scan west"), 0);
  EXPECT_EQ(run("--help"), 0);
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(run(truth + " " + results + " --min-samples none"), 2);
  EXPECT_EQ(run(truth + " " + results + " --scan north"), 4);
  EXPECT_EQ(run(results + " " + truth), 4);
}

}  // namespace score_tests
