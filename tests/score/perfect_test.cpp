#include "marks.hpp"

namespace score_tests {

TEST_F(PerfectRoom, the_truth_itself_gets_perfect_marks) {
  const auto& marks = perfect_marks();
  for (const auto& scan : marks["scans"]) {
    const auto& planes = scan["planes"];
    EXPECT_EQ(planes["measured_samples"], planes["input_samples"]);
    EXPECT_EQ(planes["planar_samples_right_share"], 1.0);
    EXPECT_GT(planes["planes"], 5);
    EXPECT_EQ(planes["planes_found"], planes["planes"]);
    EXPECT_EQ(planes["curved_called_planar_share"], 0.0);
    EXPECT_GT(planes["boundary"]["displaced"]["borders"], 1000);
    EXPECT_EQ(planes["boundary"]["displaced"]["percentile_95_samples"], 0.0);
    EXPECT_EQ(planes["boundary"]["invented"]["percentile_95_samples"], 0.0);
    EXPECT_EQ(planes["boundary"]["not_compared"], 0);
    for (const auto& hoover : planes["hoover"]) {
      EXPECT_EQ(hoover["correct"], planes["planes"]);
      for (const char* fault : {"over_segmented", "under_segmented", "missed", "noise"})
        EXPECT_EQ(hoover[fault], 0);
      EXPECT_LT(hoover["mean_angle_deg"], 1e-6);
    }
    EXPECT_EQ(planes["normals"]["planes"], planes["normals"]["within_3_bounds"]);
    EXPECT_LT(planes["normals"]["largest_of_bound"], 0.001);
    EXPECT_LT(scan["pose"]["rotation_deg"], 1e-6);
    EXPECT_LT(scan["pose"]["translation_mm"], 1e-9);
    EXPECT_NEAR(scan["pose"]["scale_error"], 0, 1e-12);
    EXPECT_GT(scan["decimation"]["discarded_share"], 0.9);
    EXPECT_EQ(scan["decimation"]["discarded_without_polygon"], 0);
    EXPECT_LT(scan["decimation"]["largest_mm"], 0.01);  // the truth's ranges are float
  }
  EXPECT_EQ(marks["registration"]["right"], 2);
  EXPECT_EQ(marks["views"].size(), 2u);
  for (const auto& view : marks["views"]) {
    EXPECT_EQ(view["psnr_db"], 100.0);
    EXPECT_NEAR(view["ssim"], 1, 1e-9);
    EXPECT_NEAR(view["sharpness"], 1, 1e-6);
    EXPECT_NEAR(view["detail_agreement"], 1, 1e-9);
    EXPECT_EQ(view["red_share"], view["truly_unseen_share"]);
    EXPECT_EQ(view["red_though_seen_share"], 0.0);
    EXPECT_EQ(view["bleeding_share"], 0.0);
    EXPECT_EQ(view["bleeding_at_centre_share"], 0.0);
  }
  for (const auto& opening : marks["openings"]["openings"]) {
    EXPECT_EQ(opening["open_share"], 1.0);
    EXPECT_EQ(opening["reported_share"], 1.0);
  }
  EXPECT_EQ(marks["openings"]["wrongly_open_m2"], 0.0);
  EXPECT_EQ(marks["openings"]["wrongly_reported_m2"], 0.0);
  EXPECT_TRUE(marks["not_in_these_results"].empty());
}

TEST_F(PerfectRoom, labels_alone_get_the_label_measures_alone) {
  const auto folder = empty_folder();
  const auto& scan = perfect().scans[1];
  write_range_exr(folder / "range.exr", scan.grid, scan.range_m);
  write_labels_exr(folder / "labels.exr", scan.grid);
  const auto marks = marks_of(folder);
  EXPECT_TRUE(marks["scans"][0]["planes"].is_null());  // found by its ranges: the second scan
  const auto& planes = marks["scans"][1]["planes"];
  EXPECT_EQ(planes["planar_samples_right_share"], 1.0);
  EXPECT_EQ(planes["normals_from"], "fit to the labelled samples");
  EXPECT_LT(planes["hoover"][0]["mean_angle_deg"], 1.0);  // of measured points, with their noise
  EXPECT_TRUE(marks["scans"][1]["pose"].is_null());
  EXPECT_TRUE(marks["scans"][1]["decimation"].is_null());
  EXPECT_TRUE(marks["openings"].is_null());
}

TEST_F(PerfectRoom, decimation_is_left_out_when_asked) {
  score::ScoreOptions options;
  options.decimation = false;
  const auto score = score::score_scene(truth_file(), write(perfect()), options);
  EXPECT_FALSE(score.scans.at(0).decimation.has_value());
  EXPECT_GT(score.scans.at(0).planes->labels.found, 5);
}

}  // namespace score_tests
