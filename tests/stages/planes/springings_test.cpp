#include "stages/planes/springings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "device.hpp"
#include "stages/box_room.hpp"

namespace hybrid::testing::springings_test {
namespace {

constexpr double kSpring_m = 1.5, kRadius_m = 3;  // height of the line, radius of the vault

// What stands above the line.
enum class Above { vault, wall, nothing };

struct Scene {
  RangeImage image;
  PlaneSegmentation segmentation;
};

// A wall 3 m before the scanner that ends 1.5 m above it, where a vault about an axis along x begins (or
// not); all within 8 mm of the wall has its label. `up` = -1: upside down.
Scene wall_and_vault(Above above, double up = 1) {
  Scene scene{make_range_image(120, 60), {}};
  RangeImage& image = scene.image;
  scene.segmentation.square = 5;
  scene.segmentation.sample_label.assign(image.count(), 0);
  Supercluster wall;
  wall.id = 1;
  wall.plane = {-Vec3::UnitY(), -kRadius_m};
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const double elevation = 0.7 - 0.004 * row, azimuth = std::numbers::pi / 2 + 0.01 * (30 - col);
      image.elevation_rad[static_cast<std::size_t>(row)] = elevation;
      image.azimuth_rad[static_cast<std::size_t>(col)] = azimuth;
      const Vec3 ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                     std::sin(elevation));
      double range = kRadius_m / ray.y();
      const std::size_t i = image.index(row, col);
      if (range * ray.z() > kSpring_m && above == Above::nothing) continue;
      if (range * ray.z() > kSpring_m && above == Above::vault) {
        // y^2 + (z - spring)^2 = radius^2 along the ray, farther root
        const double a = ray.tail<2>().squaredNorm(), b = kSpring_m * ray.z();
        const double c = kSpring_m * kSpring_m - kRadius_m * kRadius_m;
        range = (b + std::sqrt(b * b - a * c)) / a;
      }
      const Vec3 point = range * Vec3(ray.x(), ray.y(), up * ray.z());
      image.range_m[i] = static_cast<float>(range);
      image.x[i] = static_cast<float>(point.x());
      image.y[i] = static_cast<float>(point.y());
      image.z[i] = static_cast<float>(point.z());
      image.mask[i] = kMeasured;
      if (std::abs(wall.plane.distance(point)) > 0.008) continue;
      scene.segmentation.sample_label[i] = 1;
      ++wall.samples;
    }
  if (up < 0)
    for (double& elevation : image.elevation_rad) elevation = -elevation;
  scene.segmentation.superclusters = {wall};
  Cylinder vault;
  vault.id = 1;
  vault.foot = {-8, 0, up * kSpring_m};
  vault.axis = Vec3::UnitX();
  vault.length_m = 16;
  vault.radius_m = kRadius_m;
  vault.samples = 1000;
  vault.inside = true;
  scene.segmentation.cylinders = {vault};
  return scene;
}

stages::RangeNoise millimetre() {
  stages::RangeNoise noise;
  noise.base_m = 0.001;
  return noise;
}

std::int64_t labelled(const Scene& scene) {
  return std::count(scene.segmentation.sample_label.begin(), scene.segmentation.sample_label.end(), 1u);
}

TEST(Springings, a_wall_ends_where_its_vault_begins_above_or_below_it) {
  for (const double up : {1.0, -1.0}) {
    Scene scene = wall_and_vault(Above::vault, up);
    const std::int64_t before = labelled(scene);
    stages::trim_springings(scene.image, millimetre(), {}, scene.segmentation);
    std::int64_t of_wall = 0;
    for (std::size_t i = 0; i < scene.image.count(); ++i) {
      const bool below = up * scene.image.point(i).z() <= kSpring_m;
      of_wall += below;
      EXPECT_EQ(scene.segmentation.sample_label[i], below ? 1u : 0u) << i;
    }
    ASSERT_GT(before, of_wall + 500);
    const Supercluster& wall = scene.segmentation.superclusters[0];
    EXPECT_EQ(wall.id, 1u);
    EXPECT_EQ(wall.samples, of_wall);
    EXPECT_EQ(scene.segmentation.cylinders[0].samples, 1000 + before - of_wall);
    EXPECT_NEAR(wall.plane.offset_m, -kRadius_m, 1e-5);
    EXPECT_LT(wall.rms_m, 1e-5);
    EXPECT_LT(up * wall.centroid_m.z(), kSpring_m);
  }
}

TEST(Springings, a_wall_that_goes_on_or_whose_vault_nobody_sees_keeps_its_samples) {
  for (const Above above : {Above::wall, Above::nothing}) {
    Scene scene = wall_and_vault(above);
    const auto before = scene.segmentation.sample_label;
    stages::trim_springings(scene.image, millimetre(), {}, scene.segmentation);
    EXPECT_EQ(scene.segmentation.sample_label, before);
    EXPECT_EQ(scene.segmentation.cylinders[0].samples, 1000);
  }
}

TEST(Springings, only_a_cylinder_seen_from_inside_that_touches_the_plane_takes_samples) {
  for (const int what : {0, 1, 2}) {
    Scene scene = wall_and_vault(Above::vault);
    Cylinder& vault = scene.segmentation.cylinders[0];
    if (what == 0) vault.inside = false;
    if (what == 1) vault.radius_m -= 0.05;
    if (what == 2) vault.axis = Vec3(1, 0.1, 0).normalized();
    const auto before = scene.segmentation.sample_label;
    stages::trim_springings(scene.image, millimetre(), {}, scene.segmentation);
    EXPECT_EQ(scene.segmentation.sample_label, before) << what;
  }
}

}  // namespace
}  // namespace hybrid::testing::springings_test
