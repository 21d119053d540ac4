// Two implementations that share no line: hybrid-score's figures and those hybrid run writes to summary.json.
#include "marks.hpp"
#include "places.hpp"
#include "score/read/files.hpp"

namespace score_tests {

TEST_F(PerfectRoom, the_score_agrees_with_the_runs_own_figures) {
  const auto folder = std::filesystem::path(HYBRID_E2E_DIR) / "result";
  const auto marks = marks_of(folder);
  const auto summary = score::read_json(folder / "summary.json");
  ASSERT_EQ(marks["scans"].size(), summary["scans"].size());
  for (std::size_t i = 0; i < marks["scans"].size(); ++i) {
    const auto& ours = marks["scans"][i];
    const auto& theirs = summary["scans"][i]["truth"];
    EXPECT_EQ(ours["planes"]["planar_samples"], theirs["planar_samples"]);
    EXPECT_NEAR(ours["planes"]["planar_samples_right_share"], theirs["planar_samples_right_share"], 1e-12);
    EXPECT_EQ(ours["planes"]["planes"], theirs["planes_of_100_samples"]);
    EXPECT_EQ(ours["planes"]["planes_found"], theirs["planes_found"]);
    EXPECT_EQ(ours["planes"]["curved_samples"], theirs["curved_samples"]);
    EXPECT_NEAR(ours["planes"]["curved_called_planar_share"], theirs["curved_called_planar_share"], 1e-12);
    EXPECT_NEAR(ours["pose"]["translation_mm"], theirs["pose_error_mm"], 1e-6);
    EXPECT_NEAR(ours["pose"]["rotation_deg"], theirs["pose_error_deg"], 1e-6);
    EXPECT_NEAR(ours["decimation"]["discarded_share"], summary["scans"][i]["decimation"]["discarded_share"],
                1e-3);
  }
  int compared = 0;
  for (const auto& ours : marks["views"])
    for (const auto& theirs : summary["views"]) {
      if (ours["name"] != theirs["name"]) continue;
      EXPECT_NEAR(ours["red_share"], theirs["red_share"], 1e-12);
      if (!theirs.contains("left_out")) continue;
      ++compared;
      EXPECT_NEAR(ours["psnr_db"], theirs["left_out"]["psnr_db"], 0.001);
      EXPECT_NEAR(ours["ssim"], theirs["left_out"]["ssim"], 1e-5);
      EXPECT_NEAR(ours["share_seen"], theirs["left_out"]["share_seen"], 1e-12);
    }
  EXPECT_EQ(compared, 1);
}

}  // namespace score_tests
