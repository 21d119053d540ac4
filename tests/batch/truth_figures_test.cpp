#include "batch/truth_figures.hpp"

#include <gtest/gtest.h>

namespace hybrid::batch {
namespace {

// Three hundred samples in one row: 0..99 on plane 1, 100..199 on plane 2, 200..299 curved; labels as truth.
struct Fixture {
  ScanProduct product;
  io::ScanTruth truth;

  Fixture() {
    product.image = make_range_image(1, 300);
    product.segmentation.superclusters.resize(2);
    for (std::uint32_t i = 0; i < 300; ++i) {
      product.image.mask[i] = kMeasured;
      product.image.source[i] = i;
      truth.plane.push_back(i < 100 ? 1 : i < 200 ? 2 : 0);
      truth.kind.push_back(i < 200 ? 0 : 1);
      product.segmentation.sample_label.push_back(i < 100 ? 1 : i < 200 ? 2 : 0);
    }
  }
};

}  // namespace

TEST(TruthFigures, perfect_labels_score_one) {
  const Fixture f;
  const auto figures = truth_figures(f.truth, f.product, nullptr);
  EXPECT_EQ(figures["planar_samples_right_share"], 1.0);
  EXPECT_EQ(figures["planes_found"], 2);
  EXPECT_EQ(figures["curved_called_planar_share"], 0.0);
  EXPECT_FALSE(figures.contains("pose_error_mm"));
}

TEST(TruthFigures, merged_planes_count_for_the_majority_only) {
  Fixture f;
  for (std::size_t i = 100; i < 180; ++i) f.product.segmentation.sample_label[i] = 1;
  const auto figures = truth_figures(f.truth, f.product, nullptr);
  EXPECT_DOUBLE_EQ(figures["planar_samples_right_share"], 120.0 / 200);
  EXPECT_EQ(figures["planes_found"], 1);
}

TEST(TruthFigures, unlabelled_planar_samples_are_wrong) {
  Fixture f;
  for (std::size_t i = 0; i < 30; ++i) f.product.segmentation.sample_label[i] = 0;
  EXPECT_DOUBLE_EQ(truth_figures(f.truth, f.product, nullptr)["planar_samples_right_share"], 170.0 / 200);
}

TEST(TruthFigures, curved_samples_with_a_label_are_counted) {
  Fixture f;
  for (std::size_t i = 200; i < 210; ++i) f.product.segmentation.sample_label[i] = 1;
  EXPECT_DOUBLE_EQ(truth_figures(f.truth, f.product, nullptr)["curved_called_planar_share"], 0.1);
}

TEST(TruthFigures, pose_error_in_millimetres_and_degrees) {
  const Fixture f;
  Pose pose;
  pose.translation = Vec3(0.003, 0, 0.004);
  pose.rotation = Eigen::AngleAxisd(0.5 * M_PI / 180, Vec3::UnitX());
  const auto figures = truth_figures(f.truth, f.product, &pose);
  EXPECT_NEAR(figures["pose_error_mm"], 5, 1e-9);
  EXPECT_NEAR(figures["pose_error_deg"], 0.5, 1e-9);
}

}  // namespace hybrid::batch
