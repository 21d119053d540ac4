#include "geometry/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/project_points_case.hpp"
#include "core/error.hpp"

namespace hybrid {
namespace {

TEST(camera, ray_undoes_project_for_every_model) {
  for (const auto& [name, camera] : testing::camera_models()) {
    SCOPED_TRACE(name);
    int seen = 0;
    for (double v : {0.0, 0.1, 0.5, 0.77, 0.999}) {
      for (double u : {0.0, 0.1, 0.5, 0.77, 0.999}) {
        const Vec2 pixel(u * camera.width, v * camera.height);
        const Vec3 ray = camera.ray(pixel);
        if (std::isnan(ray.x())) continue;
        EXPECT_NEAR(ray.norm(), 1, 1e-14);
        // The corner itself may come back outside by rounding.
        if (u == 0 || v == 0) continue;
        const auto back = camera.project(7.5 * ray);
        ASSERT_TRUE(back) << pixel.transpose();
        EXPECT_NEAR((*back - pixel).norm(), 0, 1e-8);
        ++seen;
      }
    }
    EXPECT_EQ(seen, 16);  // every pixel of these images has its direction
  }
}

// The other way round: a direction that is seen is the ray of where it is seen.
TEST(camera, project_undoes_ray_for_every_model) {
  for (const auto& [name, camera] : testing::camera_models()) {
    SCOPED_TRACE(name);
    int seen = 0;
    for (double x = -1.5; x <= 1.5; x += 0.05)
      for (double y = -1.5; y <= 1.5; y += 0.05) {
        const Vec3 point(x, y, 1);
        const auto pixel = camera.project(point);
        if (!pixel) continue;
        ++seen;
        EXPECT_NEAR((camera.ray(*pixel) - point.normalized()).norm(), 0, 1e-9) << x << " " << y;
      }
    EXPECT_GT(seen, 60);
  }
}

TEST(camera, axes_are_right_down_forward_and_the_first_pixel_centre_is_one_half) {
  const Camera camera{4, 4, 2, 2, 2, 2, 0, 0, 0, 0};
  EXPECT_EQ(*camera.project({0, 0, 1}), Vec2(2, 2));
  EXPECT_EQ(*camera.project({0.25, 0, 1}), Vec2(2.5, 2));  // right
  EXPECT_EQ(*camera.project({0, 0.25, 1}), Vec2(2, 2.5));  // down
  EXPECT_EQ(*camera.project({-0.75, -0.75, 1}), Vec2(0.5, 0.5));
}

TEST(camera, nothing_behind_or_outside) {
  const Camera camera{4, 4, 2, 2, 2, 2, 0, 0, 0, 0};
  EXPECT_FALSE(camera.project({0, 0, -1}));
  EXPECT_FALSE(camera.project({0, 0, 0}));
  EXPECT_FALSE(camera.project({0, 0, NAN}));
  EXPECT_FALSE(camera.project({NAN, 0, 1}));
  EXPECT_FALSE(camera.project({1.001, 0, 1}));
  EXPECT_TRUE(camera.project({-1, 0, 1}));  // the left edge belongs to the image,
  EXPECT_FALSE(camera.project({1, 0, 1}));  // the right one to the next
}

// OpenCV's formula written out for one point by hand.
TEST(camera, distortion_by_hand) {
  const Camera camera{1000, 1000, 100, 200, 500, 400, 0.1, 0.01, 0.001, 0.002};
  const double x = 0.5, y = -0.25, r2 = 0.3125, radial = 1 + 0.1 * r2 + 0.01 * r2 * r2;
  const Vec2 pixel = *camera.project({1.0, -0.5, 2.0});
  EXPECT_NEAR(pixel.x(), 100 * (x * radial + 2 * 0.001 * x * y + 0.002 * (r2 + 2 * x * x)) + 500, 1e-10);
  EXPECT_NEAR(pixel.y(), 200 * (y * radial + 2 * 0.002 * x * y + 0.001 * (r2 + 2 * y * y)) + 400, 1e-10);
}

// Beyond this radius the radial distortion maps back into the image: such points must not be seen.
TEST(camera, the_fold_back_radius_is_where_the_distortion_stops_growing) {
  const auto distorted = [](const Camera& c, double r2) {
    return std::sqrt(r2) * (1 + r2 * (c.k1 + r2 * c.k2));
  };
  const std::vector<std::array<double, 2>> folding = {
      {-0.2, 0}, {-0.2, 0.005}, {0.1, -0.02}, {0, -0.05}, {-0.3, -0.1}};
  for (const auto& [k1, k2] : folding) {
    const Camera camera{1 << 20, 1 << 20, 10, 10, 1 << 19, 1 << 19, k1, k2, 0, 0};
    const double fold = camera.max_radius2();
    SCOPED_TRACE(fold);
    ASSERT_TRUE(std::isfinite(fold));
    EXPECT_LT(distorted(camera, 0.98 * fold), distorted(camera, fold));
    EXPECT_LT(distorted(camera, 1.02 * fold), distorted(camera, fold));
    for (double before = 0; before < 0.95; before += 0.05)
      EXPECT_LT(distorted(camera, before * fold), distorted(camera, (before + 0.05) * fold));
    EXPECT_TRUE(camera.project({0.99 * std::sqrt(fold), 0, 1}));
    EXPECT_FALSE(camera.project({1.01 * std::sqrt(fold), 0, 1}));
  }
}

// The same for the other lenses, whose growth has no formula: sampled along the radius.
TEST(camera, fold_of_rational_and_fisheye_lenses) {
  const std::vector<Camera> folding = {
      {1 << 20, 1 << 20, 10, 10, 1 << 19, 1 << 19, -0.2, 0.02, 0, 0, -0.01},
      {1 << 20, 1 << 20, 10, 10, 1 << 19, 1 << 19, 0, 0, 0, 0, 0, 0.5, 0.1},
      {1 << 20, 1 << 20, 10, 10, 1 << 19, 1 << 19, 0.3, 0, 0, 0, 0, 0.2, 0.1, 0.3},
      {1 << 20, 1 << 20, 10, 10, 1 << 19, 1 << 19, -0.2, 0, 0, 0, 0, 0, 0, 0, Lens::fisheye},
      {1 << 20, 1 << 20, 10, 10, 1 << 19, 1 << 19, 0.1, -0.1, 0, 0, 0.01, -0.01, 0, 0, Lens::fisheye},
  };
  for (const Camera& camera : folding) {
    const double fold = std::sqrt(camera.max_radius2()), centre = camera.cx;
    SCOPED_TRACE(fold);
    ASSERT_TRUE(std::isfinite(fold));
    double before = 0;
    for (int i = 1; i < 100; ++i) {
      const auto pixel = camera.project({fold * i / 100, 0, 1});
      ASSERT_TRUE(pixel);
      EXPECT_GT(pixel->x() - centre, before);
      before = pixel->x() - centre;
    }
    EXPECT_FALSE(camera.project({1.001 * fold, 0, 1}));
    EXPECT_TRUE(camera.ray({centre + 1.01 * before, camera.cy}).array().isNaN().all());
  }
}

// A pole of the rational lens: the image runs away to infinity there and comes back from the other side.
TEST(camera, nothing_is_seen_beyond_a_pole) {
  const Camera camera{1000, 1000, 100, 100, 500, 500, 0, 0, 0, 0, 0, -0.5};
  EXPECT_DOUBLE_EQ(camera.max_radius2(), 2);
  EXPECT_TRUE(camera.project({1, 0, 1}));
  EXPECT_FALSE(camera.project({1.5, 0, 1}));
}

TEST(camera, a_fisheye_by_hand) {
  const Camera camera{1000, 1000, 200, 300, 500, 400, 0.1, 0.01, 0, 0, 0.001, 0.0001, 0, 0, Lens::fisheye};
  // 60 degrees to the right and as much down: the direction's angle is the arc tangent of sqrt(6).
  const double a = std::atan(std::sqrt(6.0));
  const double bent =
      a + 0.1 * std::pow(a, 3) + 0.01 * std::pow(a, 5) + 0.001 * std::pow(a, 7) + 0.0001 * std::pow(a, 9);
  const Vec2 pixel = *camera.project({std::sqrt(3.0), std::sqrt(3.0), 1});
  EXPECT_NEAR(pixel.x(), 200 * bent / std::sqrt(2.0) + 500, 1e-9);
  EXPECT_NEAR(pixel.y(), 300 * bent / std::sqrt(2.0) + 400, 1e-9);
}

TEST(camera, no_fold_without_one) {
  for (const auto& [k1, k2] :
       std::vector<std::array<double, 2>>{{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}, {-0.2, 0.1}})
    EXPECT_TRUE(std::isinf((Camera{1, 1, 1, 1, 0, 0, k1, k2, 0, 0}).max_radius2())) << k1 << " " << k2;
}

TEST(camera, look_at_centres_the_target_and_keeps_up_up) {
  const Vec3 eye(3, -10, 1.6), target(0, 0, 3);
  const Photograph view = look_at(eye, target, {0, 0, 1}, 60, 1920, 1080);
  EXPECT_NEAR((view.centre() - eye).norm(), 0, 1e-12);
  EXPECT_NEAR((*view.camera.project(view.cam_from_world * target) - Vec2(960, 540)).norm(), 0, 1e-9);
  const Vec2 above = *view.camera.project(view.cam_from_world * Vec3(0, 0, 3.5));
  EXPECT_LT(above.y(), 540);
  EXPECT_NEAR(above.x(), 960, 1e-9);
  EXPECT_GT(view.camera.project(view.cam_from_world * Vec3(1, 0, 3))->x(), 960);
  // The full height spans fov_deg.
  EXPECT_NEAR(std::atan(540 / view.camera.fy) * 360 / std::numbers::pi, 60, 1e-12);
}

TEST(camera, look_around_sees_all_directions_with_up_at_its_zenith) {
  const Vec3 eye(3, -10, 1.6), target(0, 0, 3);  // looked at from below: the panorama stays level
  const Photograph view = look_around(eye, target, {0, 0, 2}, 360, 180);
  EXPECT_NEAR((view.centre() - eye).norm(), 0, 1e-12);
  EXPECT_TRUE(view.camera.wraps() && view.camera.reaches_zenith() && view.camera.reaches_nadir());
  const auto pixel = [&](const Vec3& direction) {
    return *view.camera.project(view.cam_from_world * (eye + 7 * direction));
  };
  const Vec3 level = (target - eye - Vec3(0, 0, 1.4)).normalized();
  EXPECT_NEAR((pixel(level) - Vec2(180, 90)).norm(), 0, 1e-9);
  EXPECT_NEAR(pixel((target - eye).normalized()).x(), 180, 1e-9);
  EXPECT_LT(pixel((target - eye).normalized()).y(), 90);
  EXPECT_NEAR((pixel(level.cross(Vec3::UnitZ())) - Vec2(270, 90)).norm(), 0, 1e-9);
  EXPECT_NEAR(pixel((0.001 * level + Vec3::UnitZ()).normalized()).y(), 0, 0.1);
  EXPECT_NEAR(pixel((0.001 * level - Vec3::UnitZ()).normalized()).y(), 180, 0.1);
}

TEST(camera, look_at_errors) {
  const Vec3 eye(0, 0, 0), target(0, 1, 0), up(0, 0, 1);
  const auto refuse = [](auto&&... arguments) {
    try {
      look_at(arguments...);
    } catch (const Error& error) {
      return error.kind() == ErrorKind::input;
    }
    return false;
  };
  EXPECT_TRUE(refuse(eye, eye, up, 60, 10, 10));
  EXPECT_TRUE(refuse(eye, target, target, 60, 10, 10));
  EXPECT_TRUE(refuse(eye, target, Vec3(0, 0, 0), 60, 10, 10));
  EXPECT_TRUE(refuse(Vec3(NAN, 0, 0), target, up, 60, 10, 10));
  for (double fov : {0.0, -1.0, 170.0, static_cast<double>(NAN)})
    EXPECT_TRUE(refuse(eye, target, up, fov, 10, 10));
  EXPECT_TRUE(refuse(eye, target, up, 60, 0, 10));
  EXPECT_FALSE(refuse(eye, target, up, 60, 10, 10));
}

}  // namespace
}  // namespace hybrid
