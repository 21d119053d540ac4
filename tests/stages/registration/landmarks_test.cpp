#include "stages/registration/landmarks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/error.hpp"
#include "lib/random.h"

namespace hybrid::stages::landmarks_test {
namespace {

double uniform(std::uint32_t trial, std::uint32_t draw) {
  return random_bits(11, trial, draw) / 4294967296.0 * 2 - 1;
}

Pose random_pose(std::uint32_t trial, double scale = 1) {
  Pose pose;
  pose.rotation = Eigen::AngleAxisd(
      3.1 * uniform(trial, 0), Vec3(uniform(trial, 1), uniform(trial, 2), uniform(trial, 3)).normalized());
  pose.translation = 20 * Vec3(uniform(trial, 4), uniform(trial, 5), uniform(trial, 6));
  pose.scale = scale;
  return pose;
}

std::vector<Vec3> random_points(std::uint32_t trial, std::uint32_t count) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < count; ++i)
    points.push_back(
        5 * Vec3(uniform(trial, 10 + 3 * i), uniform(trial, 11 + 3 * i), uniform(trial, 12 + 3 * i)));
  return points;
}

std::vector<Vec3> moved(const Pose& pose, const std::vector<Vec3>& points) {
  std::vector<Vec3> out;
  for (const Vec3& p : points) out.push_back(pose * p);
  return out;
}

// The paper's construction on three points: x axis along the first side, y towards the third point, z to
// complete a right-handed set.
Mat3 triad(const std::vector<Vec3>& p) {
  const Vec3 x = (p[1] - p[0]).normalized();
  const Vec3 y = ((p[2] - p[0]) - (p[2] - p[0]).dot(x) * x).normalized();
  Mat3 axes;
  axes << x, y, x.cross(y);
  return axes;
}

PolygonModel box_corners() {
  PolygonModel model;
  for (int i = 0; i < 8; ++i) model.vertices.emplace_back(i & 1 ? 6 : 0, i & 2 ? 4 : 0, i & 4 ? 3 : 0);
  return model;
}

std::vector<LandmarkPair> picks(const Pose& world_from_scan, const std::vector<int>& corners) {
  const PolygonModel model = box_corners();
  std::vector<LandmarkPair> pairs;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 corner = model.vertices[static_cast<std::size_t>(corners[i])];
    pairs.push_back({fmt::format("landmark {}", i + 1), world_from_scan.inverse() * corner, corner});
  }
  return pairs;
}

void expect_refused(const std::vector<LandmarkPair>& pairs, const std::vector<std::string>& parts) {
  try {
    fit_landmarks(box_corners(), pairs);
    ADD_FAILURE() << "accepted; expected an error with: " << parts[0];
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    for (const auto& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace

TEST(Landmarks, horn_agrees_with_the_papers_triads_on_exact_data) {
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    const auto scan = random_points(trial, 3);
    const auto world = moved(random_pose(trial), scan);
    const Mat3 expected = triad(world) * triad(scan).transpose();
    const Pose found = horn(scan, world, {}, false);
    EXPECT_LT((found.rotation.toRotationMatrix() - expected).norm(), 1e-9) << trial;
  }
}

TEST(Landmarks, horn_recovers_similarities_and_leaves_nothing_to_gain) {
  for (std::uint32_t trial = 0; trial < 100; ++trial) {
    const auto scan = random_points(trial, 6);
    const Pose truth = random_pose(trial, 1 + 0.5 * uniform(trial, 90));
    const Pose found = horn(scan, moved(truth, scan), {}, true);
    EXPECT_NEAR(found.scale, truth.scale, 1e-12);
    EXPECT_LT(difference(found, truth).angle_rad, 1e-7);  // acos near 1 keeps half of the digits
    EXPECT_LT(difference(found, truth).distance_m, 1e-10);

    auto noisy = moved(random_pose(trial), scan);
    std::vector<double> weights;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      for (int a = 0; a < 3; ++a)
        noisy[i](a) +=
            0.1 * uniform(trial, 100 + static_cast<std::uint32_t>(3 * i) + static_cast<std::uint32_t>(a));
      weights.push_back(0.5 + static_cast<double>(i));
    }
    auto cost = [&](const Pose& pose) {
      double sum = 0;
      for (std::size_t i = 0; i < scan.size(); ++i)
        sum += weights[i] * (pose * scan[i] - noisy[i]).squaredNorm();
      return sum;
    };
    const Pose best = horn(scan, noisy, weights, false);
    for (int axis = 0; axis < 6; ++axis)
      for (double step : {-1e-4, 1e-4}) {
        Pose other = best;
        if (axis < 3)
          other.translation(axis) += step;
        else
          other.rotation = Eigen::AngleAxisd(step, Vec3::Unit(axis - 3)) * other.rotation;
        EXPECT_GT(cost(other), cost(best));
      }
  }
}

TEST(Landmarks, align_forth_and_back_is_the_identity) {
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const auto scan = random_points(trial, 5);
    const auto world = moved(random_pose(trial), scan);
    const Pose round = horn(scan, world, {}, false) * horn(world, scan, {}, false);
    EXPECT_LT(difference(round, Pose{}).angle_rad, 1e-7);
    EXPECT_LT(difference(round, Pose{}).distance_m, 1e-10);
  }
}

TEST(Landmarks, keeps_digits_far_from_the_origin) {
  Pose truth = random_pose(3);
  truth.translation += Vec3(530000, 180000, 0);
  const auto scan = random_points(3, 4);
  const Pose found = horn(scan, moved(truth, scan), {}, true);
  EXPECT_LT(difference(found, truth).distance_m, 1e-8);
}

TEST(Landmarks, snaps_rough_picks_to_vertices) {
  const Pose truth = random_pose(4);
  auto pairs = picks(truth, {0, 1, 2, 7});
  for (auto& pair : pairs) pair.point_in_model += Vec3(0.03, -0.04, 0.02);
  const auto fit = fit_landmarks(box_corners(), pairs);
  EXPECT_LT(difference(fit.world_from_scan, truth).distance_m, 1e-9);
  EXPECT_LT(fit.rms_m, 1e-9);
  EXPECT_EQ(fit.world_from_scan.scale, 1);
  EXPECT_EQ(fit.leave_one_out_m.size(), 4u);

  // The same picks as control points are taken as they are: a common shift of the world.
  for (auto& pair : pairs) pair.snap = false;
  const auto shifted = fit_landmarks(box_corners(), pairs);
  EXPECT_NEAR((shifted.world_from_scan.translation - truth.translation - Vec3(0.03, -0.04, 0.02)).norm(), 0,
              1e-9);
}

TEST(Landmarks, tells_the_unit_and_the_axis_that_make_all_picks_corners) {
  const auto words = [](const std::function<Vec3(const Vec3&)>& exported) {
    PolygonModel model = box_corners();
    std::vector<LandmarkPair> pairs;
    for (const int corner : {0, 3, 5, 6}) {
      const Vec3 pick = model.vertices[static_cast<std::size_t>(corner)] + Vec3(0.01, 0, 0);
      pairs.push_back({"", pick, pick});
    }
    for (Vec3& vertex : model.vertices) vertex = exported(vertex);
    try {
      fit_landmarks(model, pairs);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto expect = [&](const std::function<Vec3(const Vec3&)>& exported, const std::string& part) {
    const std::string text = words(exported);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const auto y_up = [](const Vec3& v) { return Vec3(v.x(), v.z(), -v.y()); };
  expect([](const Vec3& v) { return Vec3(1000 * v); }, "if the model is in millimetres: say unit = \"mm\"");
  expect([](const Vec3& v) { return Vec3(v / 0.0254); }, "if the model is in inches: scale it by 0.0254");
  expect([](const Vec3& v) { return Vec3(v / 1000); }, "in metres, and was read as millimetres");
  expect(y_up, "if the model has y up: say up = \"y\"");
  expect([&](const Vec3& v) { return Vec3(1000 * y_up(v)); },
         "is in millimetres and has y up: say unit = \"mm\" in [model], and say up = \"y\"");
  const std::string elsewhere = words([](const Vec3& v) { return Vec3(v + Vec3(50, 0, 0)); });
  EXPECT_NE(elsewhere.find("expected a model vertex"), std::string::npos);
  EXPECT_EQ(elsewhere.find("all picks"), std::string::npos) << elsewhere;
}

TEST(Landmarks, names_the_pick_that_does_not_fit) {
  // Errors of 5 mm everywhere and one pick 25 cm off: over all trials no good pick may be named.
  int named = 0;
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    auto pairs = picks(random_pose(trial), {0, 1, 2, 4, 7, 6});
    for (std::size_t i = 0; i < pairs.size(); ++i)
      for (int a = 0; a < 3; ++a)
        pairs[i].point_in_scan(a) +=
            0.005 * uniform(trial, 20 + static_cast<std::uint32_t>(3 * i) + static_cast<std::uint32_t>(a));
    EXPECT_FALSE(outlying_pick(fit_landmarks(box_corners(), pairs)).has_value());
    const std::size_t bad = trial % pairs.size();
    pairs[bad].point_in_scan +=
        0.25 * Vec3(uniform(trial, 50), uniform(trial, 51), uniform(trial, 52)).normalized();
    const auto fit = fit_landmarks(box_corners(), pairs);
    const auto found = outlying_pick(fit);
    if (!found) continue;
    ++named;
    EXPECT_EQ(*found, bad);
    EXPECT_GT(fit.leave_one_out_m[bad], 0.2);
  }
  EXPECT_EQ(named, 50);
  EXPECT_FALSE(outlying_pick(fit_landmarks(box_corners(), picks(random_pose(1), {0, 1, 2}))).has_value());
}

TEST(Landmarks, leaves_out_what_the_others_cannot_judge) {
  auto pairs = picks(random_pose(5), {0, 1, 2});
  pairs.push_back({"landmark 4", random_pose(5).inverse() * Vec3(3, 0, 0), Vec3(3, 0, 0), false});
  const auto fit = fit_landmarks(box_corners(), pairs);
  EXPECT_TRUE(std::isnan(fit.leave_one_out_m[2]));  // 1, 2 and 4 lie on the edge y = z = 0
  EXPECT_LT(fit.leave_one_out_m[3], 1e-9);
}

TEST(Landmarks, refuses_what_cannot_be_fitted_and_says_which) {
  const Pose pose = random_pose(6);
  expect_refused(picks(pose, {0, 1}), {"expected at least 3 pairs", "found 2"});
  expect_refused(picks(pose, {0, 1, 7, 0}), {"landmark 1 and landmark 4 are the same point"});
  auto line = picks(pose, {0, 1, 2});
  line[2] = {"landmark 3", pose.inverse() * Vec3(2, 0.001, 0), Vec3(2, 0.001, 0), false};
  expect_refused(
      line, {"landmark 1, landmark 2, landmark 3 are collinear in the scan", "landmark 1 to landmark 2"});
  auto far = picks(pose, {0, 1, 2, 7});
  far[3].point_in_model += Vec3(0, 0, 0.25);
  expect_refused(far, {"landmark 4", "vertex 7 at (6.000, 4.000, 3.000)", "0.250 m away", "snap = false"});
  auto infinite = picks(pose, {0, 1, 2, 7});
  infinite[1].point_in_scan.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(infinite, {"landmark 2: expected finite coordinates"});
  infinite[1].point_in_scan.x() = 1e300;
  expect_refused(infinite, {"landmark 2: expected coordinates of at most 1e+12 m", "found scan (1e+300, "});
}

}  // namespace hybrid::stages::landmarks_test
