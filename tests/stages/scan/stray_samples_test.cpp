#include "stages/scan/stray_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "device.hpp"

namespace hybrid::testing::stray_samples_test {
namespace {

constexpr double kSigma = 0.002, kStep = 0.0035;

// A post 2 m away before a wall at 5 m, a floor 1.5 m below, 2 mm of noise; the column of samples beside the
// post's right edge is mixed, weights as the beam's share on the post varies.
struct StepScene {
  RangeImage image = make_range_image(160, 120);
  std::vector<std::uint8_t> mixed;

  StepScene() {
    mixed.assign(image.count(), 0);
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, kSigma);
    std::uniform_real_distribution<double> share(0.1, 0.9);
    double weight = 0.5;
    for (int row = 0; row < image.rows; ++row) {
      image.elevation_rad[static_cast<std::size_t>(row)] = kStep * (60 - row);
      if (row % 4 == 0) weight = share(random);  // runs of equal mixture, as along a straight edge
      for (int col = 0; col < image.cols; ++col) {
        image.azimuth_rad[static_cast<std::size_t>(col)] = kStep * col;
        const double el = kStep * (60 - row), az = kStep * col;
        double far = 5 / std::cos(az - 0.2) / std::cos(el);
        if (el < 0) far = std::min(far, -0.9 / std::sin(el));
        const double near = 2 / std::cos(az - 0.2) / std::cos(el);
        const std::size_t i = image.index(row, col);
        double range = col >= 40 && col < 60 ? near : far;
        if (col == 60) {
          mixed[i] = 1;
          range = weight * near + (1 - weight) * far;
        }
        set(i, range + noise(random), el, az);
      }
    }
  }
  void set(std::size_t i, double range, double el, double az) {
    image.mask[i] = kMeasured;
    image.range_m[i] = static_cast<float>(range);
    image.x[i] = static_cast<float>(range * std::cos(el) * std::cos(az));
    image.y[i] = static_cast<float>(range * std::cos(el) * std::sin(az));
    image.z[i] = static_cast<float>(range * std::sin(el));
  }
  std::vector<std::uint8_t> find(const stages::StrayOptions& options = {}) const {
    const std::vector<std::uint32_t> none(image.count(), 0);
    return stages::find_stray_samples(queue(), image, none, kSigma, options);
  }
};

}  // namespace

TEST(StraySamplesStage, finds_mixed_samples_and_keeps_both_surfaces_to_their_borders) {
  const StepScene scene;
  const auto stray = scene.find();
  int mixed = 0, found = 0;
  for (std::size_t i = 0; i < stray.size(); ++i) {
    const auto col = i % 120;
    if (scene.mixed[i]) {
      ++mixed;
      found += stray[i] != stages::kNotStray;
    } else {
      ASSERT_EQ(stray[i], stages::kNotStray) << "row " << i / 120 << " column " << col;
    }
  }
  EXPECT_GE(found, 0.9 * mixed) << "of " << mixed;  // some happen to lie on a plane
}

TEST(StraySamplesStage, a_lone_sample_is_isolated_and_a_wire_is_not) {
  StepScene scene;
  const auto lone = scene.image.index(20, 100);
  scene.set(lone, 1.0, scene.image.elevation_rad[20], scene.image.azimuth_rad[100]);
  for (int row = 5; row < 50; ++row)
    scene.set(scene.image.index(row, 80), 3.0, scene.image.elevation_rad[static_cast<std::size_t>(row)],
              scene.image.azimuth_rad[80]);
  const auto stray = scene.find();
  EXPECT_EQ(stray[lone], stages::kIsolated);
  for (int row = 7; row < 48; ++row) ASSERT_EQ(stray[scene.image.index(row, 80)], stages::kNotStray) << row;
}

TEST(StraySamplesStage, labelled_interpolated_and_empty_nodes_are_never_stray) {
  StepScene scene;
  std::vector<std::uint32_t> label(scene.image.count(), 0);
  for (int row = 0; row < scene.image.rows; ++row) {
    const auto i = scene.image.index(row, 60);
    if (row % 3 == 0) label[i] = 1;
    if (row % 3 == 1) scene.image.mask[i] = kInterpolated;
    if (row % 3 == 2) scene.image.mask[i] = kEmpty;
  }
  for (const std::uint8_t stray : stages::find_stray_samples(queue(), scene.image, label, kSigma))
    ASSERT_EQ(stray, stages::kNotStray);
  label.pop_back();
  EXPECT_THROW(stages::find_stray_samples(queue(), scene.image, label, kSigma), Error);
}

TEST(StraySamplesStage, tiles_agree_across_the_seam_and_small_images_are_no_error) {
  StepScene scene;
  scene.image.wraps = true;
  stages::StrayOptions tiled;
  tiled.tile = 37;
  EXPECT_EQ(scene.find(), scene.find(tiled));
  for (const auto& [rows, cols] : {std::pair{0, 0}, std::pair{1, 1}, std::pair{3, 2}}) {
    RangeImage image = make_range_image(rows, cols);
    image.wraps = true;
    std::fill(image.mask.begin(), image.mask.end(), std::uint8_t{kMeasured});
    std::fill(image.x.begin(), image.x.end(), 1.0f);
    std::fill(image.y.begin(), image.y.end(), 0.0f);
    std::fill(image.z.begin(), image.z.end(), 0.0f);
    const std::vector<std::uint32_t> none(image.count(), 0);
    const auto stray = stages::find_stray_samples(queue(), image, none, kSigma);
    EXPECT_EQ(stray, std::vector<std::uint8_t>(image.count(), stages::kNotStray));
  }
}

}  // namespace hybrid::testing::stray_samples_test
