#include "stages/rendering/sight_cone.hpp"

#include <gtest/gtest.h>

#include <random>

namespace hybrid::stages::sight_cone_test {
namespace {

Camera pinhole() {
  return {.width = 640, .height = 480, .fx = 500, .fy = 510, .cx = 300, .cy = 250};
}

Camera barrel() {
  Camera camera = pinhole();
  camera.fx = camera.fy = 300;
  camera.k1 = -0.25;
  camera.k2 = 0.05;
  camera.p1 = 0.002;
  return camera;
}

Camera pincushion() {
  Camera camera = pinhole();
  camera.k1 = 0.2;
  return camera;
}

Camera fisheye() {
  Camera camera = pinhole();
  camera.lens = Lens::fisheye;
  camera.fx = camera.fy = 250;
  camera.k1 = 0.03;
  return camera;
}

// The principal point outside the picture: a part of a larger one.
Camera cropped() {
  Camera camera = pinhole();
  camera.cx = -200;
  return camera;
}

Camera panorama() {
  return {.width = 720,
          .height = 360,
          .fx = 720 / (2 * M_PI),
          .fy = 720 / (2 * M_PI),
          .cx = 360,
          .cy = 180,
          .lens = Lens::spherical};
}

Photograph placed(const Camera& camera) {
  Photograph photograph = look_at(Vec3(1, 2, 3), Vec3(4, 4, 2), Vec3::UnitZ(), 40, 64, 48);
  photograph.camera = camera;
  return photograph;
}

struct Counts {
  int shown = 0, ruled_out = 0;
};

// Balls about the camera; whatever is seen of one must not be ruled out.
Counts check(const Camera& camera) {
  const Photograph photograph = placed(camera);
  const SightCone cone(photograph);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Counts counts;
  for (int trial = 0; trial < 20'000; ++trial) {
    const Vec3 point = photograph.centre() + 5 * Vec3(normal(random), normal(random), normal(random));
    const double radius = std::abs(normal(random));
    const Vec3 centre =
        point + 0.99 * radius * Vec3(normal(random), normal(random), normal(random)).normalized();
    const bool shown = camera.project(photograph.cam_from_world * point).has_value();
    counts.shown += shown;
    EXPECT_TRUE(!shown || cone.meets_ball(point, 0)) << point.transpose();
    EXPECT_TRUE(!shown || cone.meets_ball(centre, radius)) << centre.transpose() << ", " << radius;
    counts.ruled_out += !cone.meets_ball(centre, radius);
  }
  return counts;
}

}  // namespace

TEST(SightCone, HoldsAllThatALensShows) {
  for (const Camera& camera : {pinhole(), barrel(), pincushion(), fisheye(), cropped()}) {
    const Counts counts = check(camera);
    EXPECT_GT(counts.shown, 200);
    EXPECT_GT(counts.ruled_out, 5'000);
  }
}

TEST(SightCone, APanoramaLooksEverywhere) {
  EXPECT_EQ(check(panorama()).ruled_out, 0);
}

TEST(SightCone, ANarrowLensRulesOutWhatIsJustOutside) {
  const Photograph photograph = placed(pinhole());
  const SightCone cone(photograph);
  const auto at = [&](double degrees) -> Vec3 {
    const double angle = degrees * M_PI / 180;
    return photograph.cam_from_world.inverse() * Vec3(10 * std::sin(angle), 0, 10 * std::cos(angle));
  };
  EXPECT_TRUE(cone.meets_ball(at(30), 0.1));
  EXPECT_FALSE(cone.meets_ball(at(50), 0.1));
  EXPECT_TRUE(cone.meets_ball(at(50), 3.0));
}

}  // namespace hybrid::stages::sight_cone_test
