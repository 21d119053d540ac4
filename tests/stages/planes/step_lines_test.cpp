#include "stages/planes/step_lines.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "stages/planes/plane_steps.hpp"

namespace hybrid::testing::step_lines_test {
namespace {

constexpr int kRows = 60, kCols = 120, kSquare = 4;
constexpr double kSigma_m = 0.002;
constexpr std::int64_t kLeast = 48;

// A panel 5 m ahead of 20 x 60 samples and its one plane, which goes through the middle of all of them,
// before a plain wall; `height`: metres towards the scanner, by row and column of the panel.
struct Panel {
  static constexpr int kTop = 20, kLeft = 30, kHeight = 20, kWidth = 60;

  template <typename Height>
  explicit Panel(const Height& height, unsigned seed) : image(make_range_image(kRows, kCols)) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, kSigma_m);
    labels.assign(image.count(), 2);
    for (int row = 0; row < kRows; ++row)
      for (int col = 0; col < kCols; ++col) {
        const std::size_t i = image.index(row, col);
        image.mask[i] = kMeasured;
        image.x[i] = static_cast<float>(6 + noise(random));
        image.y[i] = 0.012f * static_cast<float>(col - kCols / 2);
        image.z[i] = 0.012f * static_cast<float>(kRows / 2 - row);
      }
    Mat3 matrix = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (int row = 0; row < kHeight; ++row)
      for (int col = 0; col < kWidth; ++col) {
        const std::size_t i = image.index(kTop + row, kLeft + col);
        image.x[i] = static_cast<float>(5 - height(row, col) + noise(random));
        image.y[i] = 0.01f * static_cast<float>(kLeft + col - kCols / 2);
        image.z[i] = 0.01f * static_cast<float>(kRows / 2 - kTop - row);
        labels[i] = 1;
        const Vec3 ones(1, image.y[i], image.z[i]);
        matrix += ones * ones.transpose();
        right += double{image.x[i]} * ones;
      }
    const Vec3 fitted = matrix.ldlt().solve(right);
    const Vec3 normal(-1, fitted.y(), fitted.z());
    planes = {{normal.normalized(), -fitted.x() / normal.norm()}, {-Vec3::UnitX(), -6}};
    regions.regions.resize(2);
    squares.square = kSquare;
    squares.rows = kRows / kSquare;
    squares.cols = kCols / kSquare;
  }
  void forget(int row, int col) {
    const std::size_t i = image.index(kTop + row, kLeft + col);
    labels[i] = 0;
    image.mask[i] = kEmpty;
  }
  std::vector<stages::StepProposal> propose() const {
    return stages::propose_by_lines(image, stages::RangeNoise{kSigma_m}, labels, planes,
                                    {{1, kHeight * kWidth, kTop, kLeft, kTop + kHeight, kLeft + kWidth}}, 1,
                                    kLeast);
  }
  // Planes that it makes of the panel's one.
  std::size_t split() {
    stages::split_steps(image, stages::SquareGrid(image, squares), kSquare, stages::RangeNoise{kSigma_m},
                        {kLeast, 0.005}, labels, planes, regions);
    return planes.size() - 1;
  }

  RangeImage image;
  stages::SquarePlanes squares;
  std::vector<std::uint32_t> labels;
  std::vector<Plane> planes;
  stages::PlaneRegions regions;
};

double rail(int row, int) {
  return row < 7 ? 0.0035 : 0;
}

}  // namespace

TEST(StepLines, the_line_along_a_rail_is_found) {
  const Panel panel(rail, 1);
  const auto proposals = panel.propose();
  ASSERT_EQ(proposals.size(), 1u);
  EXPECT_EQ(proposals[0].label, 1u);
  EXPECT_NEAR(static_cast<double>(proposals[0].mean.count), 7 * 60, 60);
  ASSERT_TRUE(proposals[0].border);
  EXPECT_GT(std::abs(proposals[0].border->normal.z()), 0.99);
  int before = 0;
  for (int row = 0; row < 7; ++row)
    before += proposals[0].border->distance(panel.image.point(panel.image.index(20 + row, 60))) > 0;
  EXPECT_GE(before, 6);
}

TEST(StepLines, a_plane_through_the_middle_of_a_rail_and_its_panel_is_parted) {
  int parted = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Panel panel(rail, seed);
    if (panel.split() == 1) continue;
    parted += 1;
    ASSERT_EQ(panel.planes.size(), 3u);
    int right = 0, wrong = 0;
    for (int row = 0; row < Panel::kHeight; ++row)
      for (int col = 0; col < Panel::kWidth; ++col) {
        const auto label = panel.labels[panel.image.index(Panel::kTop + row, Panel::kLeft + col)];
        (label == 3 ? right : wrong) += row < 7 ? label == 3 : 0;
        wrong += row >= 7 && label == 3;
      }
    EXPECT_GT(right, 380);  // of 420
    EXPECT_LT(wrong, 60);
  }
  EXPECT_GE(parted, 18);
}

TEST(StepLines, a_piece_apart_on_another_plane_leaves) {
  Panel panel([](int, int col) { return col < 12 ? 0.006 : 0.0; }, 3);
  for (int row = 0; row < Panel::kHeight; ++row)
    for (int col = 12; col < 24; ++col) panel.forget(row, col);
  EXPECT_EQ(panel.split(), 2u);
}

TEST(StepLines, noise_is_no_rail) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    Panel panel([](int, int) { return 0.0; }, seed);
    EXPECT_TRUE(panel.propose().empty()) << seed;
    EXPECT_EQ(panel.split(), 1u) << seed;
  }
}

// It is no two planes, though two fit it better than one.
TEST(StepLines, a_bent_panel_is_left_alone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Panel panel([](int row, int) { return 0.00005 * (row - 10) * (row - 10); }, seed);
    EXPECT_EQ(panel.split(), 1u) << seed;
  }
}

TEST(StepLines, a_plane_of_too_few_samples_or_on_one_line_has_none) {
  Panel panel(rail, 1);
  for (int row = 0; row < Panel::kHeight; ++row)
    for (int col = 0; col < Panel::kWidth; ++col)
      if (row != 3) panel.forget(row, col);
  EXPECT_TRUE(panel.propose().empty());
  for (int col = 0; col < Panel::kWidth; ++col) panel.forget(3, col);
  EXPECT_TRUE(panel.propose().empty());
}

}  // namespace hybrid::testing::step_lines_test
