#include "stages/registration/photograph_landmarks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "lib/random.h"
#include "stages/registration/landmarks.hpp"

namespace hybrid::stages::photograph_landmarks_test {
namespace {

double uniform(std::uint32_t draw) {
  return random_bits(7, 3, draw) / 4294967296.0 * 2 - 1;
}

PolygonModel house() {
  PolygonModel model;
  for (int i = 0; i < 8; ++i) model.vertices.emplace_back(i & 1 ? 9 : 0, i & 2 ? 6 : 0, i & 4 ? 5 : 0);
  return model;
}

// Around the house and looking at it, with a lens that bends and a panorama among them.
std::vector<Photograph> around_the_house() {
  std::vector<Photograph> photographs;
  for (int i = 0; i < 4; ++i) {
    const double turn = 0.5 * i;
    const Vec3 eye = Vec3(4.5, 3, 2) + 14 * Vec3(std::cos(turn), std::sin(turn), 0.1);
    photographs.push_back(look_at(eye, {4.5, 3, 2.5}, Vec3::UnitZ(), 55, 4000, 3000));
    photographs.back().name = fmt::format("{}.jpg", i);
  }
  photographs[1].camera.k1 = -0.12;
  photographs[1].camera.p1 = 0.002;
  photographs[3] = look_around({17, 9, 2}, {4.5, 3, 2.5}, Vec3::UnitZ(), 6000, 3000);
  photographs[3].name = "3.jpg";
  return photographs;
}

Pose frame_of_cameras() {
  Pose photographs_from_world;
  photographs_from_world.scale = 0.23;
  photographs_from_world.rotation = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized());
  photographs_from_world.translation = {3, -1, 8};
  return photographs_from_world;
}

// The cameras as structure from motion has them.
std::vector<Photograph> in_frame(std::vector<Photograph> photographs, const Pose& frame_from_world) {
  for (Photograph& photograph : photographs) {
    Pose frame_from_cam = frame_from_world * photograph.cam_from_world.inverse();
    frame_from_cam.scale = 1;
    photograph.cam_from_world = frame_from_cam.inverse();
  }
  return photographs;
}

// Of corner `vertex`, off by up to `error_px` in each direction.
PhotographPick pick(const std::vector<Photograph>& photographs, std::size_t photograph, int vertex,
                    double error_px = 0) {
  PhotographPick result;
  const auto draw = static_cast<std::uint32_t>(100 * photograph + 2 * static_cast<std::size_t>(vertex));
  result.name = fmt::format("corner {} in {}", vertex, photograph);
  result.photograph = photograph;
  result.point_in_model = house().vertices[static_cast<std::size_t>(vertex)];
  const auto& seen = photographs[photograph];
  const auto at = seen.camera.project(seen.cam_from_world * result.point_in_model);
  EXPECT_TRUE(at) << result.name;
  if (at) result.pixel = *at + error_px * Vec2(uniform(draw), uniform(draw + 1));
  return result;
}

std::vector<PhotographPick> picks(const std::vector<Photograph>& photographs, double error_px = 0) {
  std::vector<PhotographPick> all;
  for (std::size_t photograph = 0; photograph < photographs.size(); ++photograph)
    for (const int vertex : {1, 2, 3, 5, 7}) all.push_back(pick(photographs, photograph, vertex, error_px));
  return all;
}

double square_sum_px(const PhotographFit& fit) {
  double sum = 0;
  for (const double miss : fit.residual_px) sum += miss * miss;
  return sum;
}

std::string problem_of(const std::vector<Photograph>& photographs, const std::vector<PhotographPick>& all) {
  try {
    fit_photographs(house(), photographs, all, 0.1);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "";
}

}  // namespace

TEST(PhotographLandmarks, find_the_frame_of_cameras_of_any_scale_and_lens) {
  const auto photographs = around_the_house();
  const Pose frame = frame_of_cameras();
  const auto fit = fit_photographs(house(), in_frame(photographs, frame), picks(photographs), 0.1);
  const Pose off = fit.world_from_photographs * frame;
  EXPECT_NEAR(off.scale, 1, 1e-9);
  EXPECT_LT(difference(off, Pose()).distance_m, 1e-8);
  EXPECT_LT(difference(off, Pose()).angle_rad, 1e-9);
  EXPECT_LT(fit.rms_m, 1e-8);
  EXPECT_FALSE(fit.left_out);
  ASSERT_EQ(fit.residual_px.size(), 20u);
  for (const double miss : fit.residual_px) EXPECT_LT(miss, 1e-5);
}

TEST(PhotographLandmarks, picks_by_hand_leave_nothing_to_gain) {
  const auto photographs = around_the_house();
  const Pose frame = frame_of_cameras();
  const auto cameras = in_frame(photographs, frame);
  const auto all = picks(photographs, 3);
  const auto fit = fit_photographs(house(), cameras, all, 0.1);
  EXPECT_FALSE(fit.left_out) << fit.warning;
  EXPECT_LT(difference(fit.world_from_photographs * frame, Pose()).distance_m, 0.02);
  // The true frame fits the picks no better, nor does any one near.
  const auto sum_at = [&](const Pose& world_from_photographs) {
    double sum = 0;
    for (const PhotographPick& one : all) {
      const auto& camera = cameras[*one.photograph];
      const Vec3 in_cam = camera.cam_from_world * (world_from_photographs.inverse() * one.point_in_model);
      const Vec3 ray = camera.camera.ray(*one.pixel);
      const double chord =
          (in_cam.normalized() - ray).norm() * std::sqrt(camera.camera.fx * camera.camera.fy);
      sum += chord * chord;
    }
    return sum;
  };
  const double least = sum_at(fit.world_from_photographs);
  EXPECT_NEAR(least, square_sum_px(fit), 1e-3 * least);
  EXPECT_LT(least, sum_at(frame.inverse()));
  for (int axis = 0; axis < 3; ++axis)
    for (const double step : {-1e-4, 1e-4}) {
      Pose shifted = fit.world_from_photographs, turned = shifted, scaled = shifted;
      shifted.translation[axis] += 10 * step;
      Pose turn;
      turn.rotation = Eigen::AngleAxisd(step, Vec3::Unit(axis));
      turned = turn * turned;
      scaled.scale *= 1 + step;
      EXPECT_LT(least, sum_at(shifted));
      EXPECT_LT(least, sum_at(turned));
      EXPECT_LT(least, sum_at(scaled));
    }
}

TEST(PhotographLandmarks, a_point_in_one_photograph_takes_part_beside_others) {
  const auto photographs = around_the_house();
  const auto cameras = in_frame(photographs, frame_of_cameras());
  std::vector<PhotographPick> all;
  for (const std::size_t photograph : {0, 2})
    for (const int vertex : {1, 3, 5}) all.push_back(pick(photographs, photograph, vertex, 2));
  const auto without = fit_photographs(house(), cameras, all, 0.1);
  all.push_back(pick(photographs, 1, 7, 2));
  const auto with = fit_photographs(house(), cameras, all, 0.1);
  ASSERT_EQ(with.residual_px.size(), 7u);
  EXPECT_LT(with.residual_px.back(), 12);
  EXPECT_GT(difference(with.world_from_photographs, without.world_from_photographs).distance_m, 1e-6);
}

TEST(PhotographLandmarks, name_the_pick_of_another_corner_and_do_without_it) {
  const auto photographs = around_the_house();
  const Pose frame = frame_of_cameras();
  auto all = picks(photographs, 1);
  all[6].pixel = all[6].pixel.value() + Vec2(-70, 40);
  const auto fit = fit_photographs(house(), in_frame(photographs, frame), all, 0.1);
  ASSERT_EQ(fit.left_out, 6u);
  EXPECT_NE(fit.warning.find("corner 2 in 1 is left out"), std::string::npos) << fit.warning;
  EXPECT_GT(fit.residual_px[6], 50);
  EXPECT_LT(fit.rms_m, 0.02);
  EXPECT_LT(difference(fit.world_from_photographs * frame, Pose()).distance_m, 0.02);
}

TEST(PhotographLandmarks, camera_positions_and_points_will_do) {
  const auto photographs = around_the_house();
  const Pose frame = frame_of_cameras();
  const auto cameras = in_frame(photographs, frame);
  std::vector<PhotographPick> all;
  for (std::size_t i = 0; i < 3; ++i) {
    PhotographPick where;
    where.photograph = i;
    where.point_in_model = photographs[i].centre();
    where.snap = false;
    all.push_back(where);
  }
  PhotographPick point;
  point.point_in_model = Vec3(9, 6, 5) + Vec3(0.04, 0, 0);  // goes to the corner
  point.point = frame * Vec3(9, 6, 5);
  all.push_back(point);
  const auto fit = fit_photographs(house(), cameras, all, 0.1);
  EXPECT_LT(difference(fit.world_from_photographs * frame, Pose()).distance_m, 1e-8);
  EXPECT_LT(fit.rms_m, 1e-8);
  for (const double miss : fit.residual_px) EXPECT_TRUE(std::isnan(miss));
}

TEST(PhotographLandmarks, refuse_what_fixes_no_frame_and_say_why) {
  const auto photographs = around_the_house();
  const auto cameras = in_frame(photographs, frame_of_cameras());
  const auto has = [&](const std::vector<PhotographPick>& all, const std::string& part) {
    const std::string problem = problem_of(cameras, all);
    EXPECT_NE(problem.find(part), std::string::npos) << problem;
  };
  std::vector<PhotographPick> one, few, line, exchanged = picks(photographs);
  for (const int vertex : {1, 2, 3, 5, 7}) one.push_back(pick(photographs, 0, vertex));
  has(one, "found 0 and 5 seen from one direction only");
  for (const std::size_t photograph : {0, 1})
    for (const int vertex : {1, 2}) few.push_back(pick(photographs, photograph, vertex));
  has(few, "expected at least 3 points");
  for (const std::size_t photograph : {0, 1})
    for (const int vertex : {1, 5}) line.push_back(pick(photographs, photograph, vertex));
  for (const std::size_t photograph : {0, 1}) {
    PhotographPick middle = pick(photographs, photograph, 1);
    middle.point_in_model = {9, 0, 2.5};
    middle.snap = false;
    middle.pixel = photographs[photograph].camera.project(photographs[photograph].cam_from_world *
                                                          middle.point_in_model);
    line.push_back(middle);
  }
  has(line, "are collinear in the cameras' frame");
  for (PhotographPick& each : exchanged)
    if (each.point_in_model == Vec3(9, 6, 5))
      each.point_in_model = {0, 0, 0};
    else if (each.point_in_model == Vec3(9, 0, 0))
      each.point_in_model = {0, 6, 5};
  has(exchanged, "the picks do not belong together");
  auto outside = picks(photographs);
  outside[0].pixel = Vec2(4100, 20);
  has(outside,
      "corner 1 in 0: pixel [19.5, 4099.5]: expected a row and a column of photograph 0.jpg, which has 3000 "
      "rows");
  auto far = picks(photographs);
  far[3].point_in_model += Vec3(0, 0, 0.5);
  has(far, "expected a model vertex within 0.1 m");
}

}  // namespace hybrid::stages::photograph_landmarks_test
