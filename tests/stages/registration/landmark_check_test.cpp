#include "stages/registration/landmark_check.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/random.h"

namespace hybrid::stages::landmark_check_test {
namespace {

PolygonModel room_corners(double scale = 1) {
  PolygonModel model;
  for (int i = 0; i < 8; ++i)
    model.vertices.push_back(scale * Vec3(i & 1 ? 6 : 0, i & 2 ? 4 : 0, i & 4 ? 3 : 0));
  return model;
}

Pose a_pose() {
  Pose pose;
  pose.rotation = Eigen::AngleAxisd(0.7, Vec3(0.1, -0.2, 1).normalized());
  pose.translation = Vec3(2, 1.5, 1.4);
  return pose;
}

// Picks of corners, each off by up to a centimetre along each axis.
std::vector<LandmarkPair> picks(const std::vector<int>& corners) {
  const PolygonModel model = room_corners();
  std::vector<LandmarkPair> pairs;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 corner = model.vertices[static_cast<std::size_t>(corners[i])];
    Vec3 error;
    for (int a = 0; a < 3; ++a)
      error(a) = 0.01 * (random_bits(3, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(a)) /
                             4294967296.0 * 2 -
                         1);
    pairs.push_back({fmt::format("landmark {}", i + 1), a_pose().inverse() * corner + error, corner});
  }
  return pairs;
}

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

const std::vector<int> kFive = {0, 7, 1, 6, 2};

}  // namespace

TEST(LandmarkCheck, good_picks_are_fitted_as_they_are) {
  for (const auto& corners : {kFive, std::vector{0, 1, 6}, std::vector{0, 1, 2, 7}}) {
    const auto pairs = picks(corners);
    const auto checked = check_landmarks(room_corners(), pairs);
    EXPECT_EQ(checked.warning, "");
    EXPECT_EQ(checked.refusal, "");
    const auto fit = fit_landmarks(room_corners(), pairs);
    EXPECT_EQ(checked.fit.residual_m, fit.residual_m);
    EXPECT_FALSE(checked.fit.left_out);
  }
}

TEST(LandmarkCheck, walls_that_are_displaced_and_rough_picks_are_no_blunders) {
  auto pairs = picks({0, 1, 2, 7, 5, 6});
  for (std::size_t i : {1u, 3u, 4u})
    pairs[i].point_in_scan += a_pose().rotation.conjugate() * Vec3(0.15, 0, 0);
  pairs[0].point_in_scan.z() += 0.1;
  EXPECT_EQ(check_landmarks(room_corners(), pairs).refusal, "");
}

TEST(LandmarkCheck, two_that_are_exchanged_are_named_and_place_nothing) {
  for (const auto& corners : {kFive, std::vector{0, 1, 6}, std::vector{0, 1, 2, 7}}) {
    auto pairs = picks(corners);
    std::swap(pairs[0].point_in_model, pairs[1].point_in_model);
    const auto checked = check_landmarks(room_corners(), pairs);
    expect_parts(checked.refusal,
                 {"do not belong together: rms", "landmark 1 and landmark 2 seem exchanged"});
  }
}

TEST(LandmarkCheck, a_bad_pick_is_named_and_left_out) {
  for (const double off_m : {0.3, 1.5}) {
    auto pairs = picks(kFive);
    pairs[1].point_in_scan.x() += off_m;
    pairs[1].place = "pixel [12, 34]";
    const auto checked = check_landmarks(room_corners(), pairs);
    EXPECT_EQ(checked.refusal, "");
    expect_parts(checked.warning, {"landmark 2, pixel [12, 34], is left out of the fit", "its own residual"});
    ASSERT_EQ(checked.fit.left_out, 1u);
    EXPECT_NEAR(checked.fit.residual_m[1], off_m, 0.05);
    EXPECT_LT(checked.fit.rms_m, 0.02);
    EXPECT_LT(difference(checked.fit.world_from_scan, a_pose()).distance_m, 0.02);
    EXPECT_EQ(checked.fit.residual_m.size(), 5u);
  }
}

// Four corners of a front, picked within a centimetre along each axis: what three of them say of the fourth
// is off by many times that. (By the miss alone 1.8 % of such fronts lost a good pick.)
TEST(LandmarkCheck, of_four_good_picks_none_is_left_out_and_a_bad_one_is) {
  PolygonModel front;
  front.vertices = {{-6.4, 0, 0}, {6.4, 0, 7.2}, {0, 0, 13}, {-6.4, 0, 7.2}};
  const auto error = [](std::uint32_t trial, std::uint32_t pick, std::uint32_t axis) {
    double sum = 0;  // of 12 uniform ones: a normal one
    for (std::uint32_t k = 0; k < 12; ++k) sum += random_bits(trial, 12 * pick + k, axis) / 4294967296.0;
    return 0.01 * (sum - 6);
  };
  int good_lost = 0, bad_found = 0;
  constexpr int kTrials = 1000;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    std::vector<LandmarkPair> pairs;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const Vec3 off(error(trial, i, 0), error(trial, i, 1), error(trial, i, 2));
      pairs.push_back({fmt::format("landmark {}", i + 1), a_pose().inverse() * front.vertices[i] + off,
                       front.vertices[i]});
    }
    good_lost += check_landmarks(front, pairs).fit.left_out.has_value();
    pairs[trial % 4].point_in_scan += Vec3(0.15, -0.1, 0.1);
    const auto checked = check_landmarks(front, pairs);
    bad_found += checked.fit.left_out == trial % 4;
  }
  EXPECT_LE(good_lost, 1);
  EXPECT_GE(bad_found, 900);
}

TEST(LandmarkCheck, a_model_of_another_scale_or_mirrored_is_told) {
  auto pairs = picks(kFive);
  for (auto& pair : pairs) pair.point_in_model *= 1000;
  expect_parts(check_landmarks(room_corners(1000), pairs).refusal,
               {"where the model is ", "times as large", "check unit"});
  LandmarkOptions free;
  free.free_scale = true;
  EXPECT_EQ(check_landmarks(room_corners(1000), pairs, free).refusal, "");

  pairs = picks(kFive);
  PolygonModel mirror = room_corners();
  for (auto& vertex : mirror.vertices) vertex.x() = -vertex.x();
  for (auto& pair : pairs) pair.point_in_model.x() = -pair.point_in_model.x();
  expect_parts(check_landmarks(mirror, pairs).refusal, {"with the model's mirror image", "negate one axis"});
}

TEST(LandmarkCheck, picks_of_no_sense_are_listed) {
  auto pairs = picks({0, 1, 2, 7, 5, 6});
  std::rotate(pairs.begin(), pairs.begin() + 1, pairs.end());
  std::vector<Vec3> corners;
  for (const auto& pair : pairs) corners.push_back(pair.point_in_model);
  std::rotate(corners.begin(), corners.begin() + 2, corners.end());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].point_in_model = corners[i];
  expect_parts(check_landmarks(room_corners(), pairs).refusal,
               {"no single pick is to blame, nor the exchange of two: landmark 2 ", "check which corners"});
}

}  // namespace hybrid::stages::landmark_check_test
