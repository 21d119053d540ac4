#include "stages/planes/cylinders.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/planes/cylinder_fit.hpp"
#include "stages/planes/cylinder_patches.hpp"

namespace hybrid::testing {
namespace {

using stages::OrientedPoint;

// Of a cylinder about `axis` through `centre`, half of it seen, `length_m` long; radius and taper as given.
std::vector<OrientedPoint> half_cylinder(const Vec3& centre, const Vec3& axis, double radius_m, double taper,
                                         double length_m, double noise_m = 0) {
  const Vec3 a = axis.unitOrthogonal(), b = axis.cross(a);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 1);
  std::vector<OrientedPoint> points;
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j <= 30; ++j) {
      const double t = (k / 39.0 - 0.5) * length_m, turn = std::numbers::pi * (j / 30.0 - 0.5);
      const Vec3 out = std::cos(turn) * a + std::sin(turn) * b;
      points.push_back({centre + t * axis + (radius_m + taper * t + noise_m * noise(random)) * out, out});
    }
  return points;
}

std::vector<Vec3> places(const std::vector<OrientedPoint>& points) {
  std::vector<Vec3> list;
  for (const auto& [point, normal] : points) list.push_back(point);
  return list;
}

std::vector<Cylinder> cylinders_of(const RoomScan& scan, double sigma_m,
                                   const stages::SuperclusterOptions& options = {}) {
  return stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, 5, sigma_m), options)
      .cylinders;
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))) * 180 / std::numbers::pi;
}

}  // namespace

TEST(CylinderFit, exact_points_give_the_cylinder_they_were_made_of) {
  const Vec3 centre(1, -2, 0.5), axis = Vec3(0.3, 0.1, 1).normalized();
  const auto points = half_cylinder(centre, axis, 0.4, 0, 2);
  const auto rough = stages::cylinder_through(points);
  ASSERT_TRUE(rough);
  EXPECT_NEAR(rough->radius_m, 0.4, 1e-9);
  EXPECT_LT(angle_deg(rough->axis, axis), 1e-4);
  const auto fitted = stages::fit_cylinder(places(points), *rough, 0.05);
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->radius_m, 0.4, 1e-9);
  EXPECT_NEAR(fitted->length_m, 2, 1e-9);
  EXPECT_NEAR((fitted->foot - (centre - axis)).norm(), 0, 1e-8);
}

TEST(CylinderFit, taper_and_lean_are_told_apart_from_one_side) {
  const Vec3 centre(0, 3, 1), axis = Vec3(0.02, 0.05, 1).normalized();
  const auto points = half_cylinder(centre, axis, 0.3, -0.015, 2.4, 0.002);
  auto start = stages::cylinder_through(points);
  ASSERT_TRUE(start);
  start->axis = Vec3(0, 0, 1);
  const auto fitted = stages::fit_cylinder(places(points), *start, 0.05);
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->taper, -0.015, 0.001);
  EXPECT_LT(angle_deg(fitted->axis, axis), 0.05);
  EXPECT_NEAR(fitted->radius_m, 0.3, 4 * fitted->sigma_radius_m);
  EXPECT_NEAR(fitted->rms_m, 0.002, 0.0003);
}

TEST(CylinderFit, vaults_are_seen_from_inside) {
  auto vault = half_cylinder({0, 0, 0}, Vec3::UnitX(), 2, 0, 3);
  for (auto& [point, normal] : vault) normal = -normal;
  const auto found = stages::cylinder_through(vault);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->inside);
  EXPECT_NEAR(found->radius_m, 2, 1e-9);
}

TEST(CylinderFit, neither_planes_nor_balls) {
  std::vector<OrientedPoint> wall, ball;
  for (int k = 0; k < 400; ++k) {
    wall.push_back({Vec3(k % 20 * 0.1, 3, k / 20 * 0.1), -Vec3::UnitY()});
    const double u = 2 * std::numbers::pi * (k % 20) / 20, z = 2 * (k / 20 + 0.5) / 20 - 1;
    const Vec3 out(std::sqrt(1 - z * z) * std::cos(u), std::sqrt(1 - z * z) * std::sin(u), z);
    ball.push_back({0.5 * out, out});
  }
  EXPECT_FALSE(stages::cylinder_through(wall));
  EXPECT_FALSE(stages::cylinder_through(ball));
  EXPECT_FALSE(stages::cylinder_through({}));
}

TEST(Cylinders, the_column_of_a_room_is_one_however_the_scanner_stands) {
  for (const double noise : {0.0005, 0.002, 0.004})
    for (const double tilt : {0.0, 0.3}) {
      BoxRoom room;
      room.noise_m = noise;
      room.turned = Eigen::AngleAxisd(tilt, Vec3(1, 0.4, 0).normalized()).toRotationMatrix();
      const auto found = cylinders_of(scan_room(room), noise);
      ASSERT_EQ(found.size(), 1u) << noise << ' ' << tilt;
      const Cylinder& column = found[0];
      EXPECT_EQ(column.id, 1u);
      EXPECT_NEAR(column.radius_m, 0.25, 0.003) << noise << ' ' << tilt;
      EXPECT_LT(angle_deg(room.turned * column.axis, Vec3::UnitZ()), 0.3);
      EXPECT_GT(column.arc_deg, 120);
      EXPECT_LT(std::abs(column.taper), 0.005);
      EXPECT_LT(column.rms_m, 1.2 * noise);
    }
}

TEST(Cylinders, a_pipe_narrower_than_two_squares_shows_itself_on_strips) {
  BoxRoom room;
  room.column_radius_m = 0.09;  // 11 nodes across, squares are 5 wide
  room.noise_m = 0.0005;
  const auto found = cylinders_of(scan_room(room), room.noise_m);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].radius_m, 0.09, 0.001);
  EXPECT_GT(found[0].length_m, 2);
  EXPECT_LT(angle_deg(found[0].axis, Vec3::UnitZ()), 0.2);
}

// A pipe along the view, its top below the scanner by so much, from 1.5 to 5 m away, before a wall.
RoomScan along_a_pipe(double below_m) {
  constexpr double kRadius_m = 0.5, kStep_rad = 0.0025;
  RoomScan scan;
  RangeImage& image = scan.image = make_range_image(320, 480);
  const double depth = below_m + kRadius_m;
  for (int row = 0; row < 320; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = 0.1 - kStep_rad * row;
  for (int col = 0; col < 480; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = std::numbers::pi / 2 + kStep_rad * (col - 239.5);
  for (int row = 0; row < 320; ++row)
    for (int col = 0; col < 480; ++col) {
      const std::size_t i = image.index(row, col);
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const double a = ray.x() * ray.x() + ray.z() * ray.z(), b = depth * ray.z(),
                   root = b * b - a * (depth * depth - kRadius_m * kRadius_m);
      const double on_pipe = root > 0 ? (-b - std::sqrt(root)) / a : 0;
      const bool hit = on_pipe * ray.y() > 1.5 && on_pipe * ray.y() < 5;
      const Vec3 point = (hit ? on_pipe : 8 / ray.y()) * ray;
      image.range_m[i] = static_cast<float>(point.norm());
      image.x[i] = static_cast<float>(point.x());
      image.y[i] = static_cast<float>(point.y());
      image.z[i] = static_cast<float>(point.z());
      image.mask[i] = kMeasured;
    }
  return scan;
}

// What every ray grazes may be anything: a pipe is one where some rays meet it.
TEST(Cylinders, none_that_every_ray_grazes) {
  EXPECT_EQ(cylinders_of(along_a_pipe(1.0), 0.0005).size(), 1u);
  EXPECT_TRUE(cylinders_of(along_a_pipe(0.4), 0.0005).empty());
}

TEST(Cylinders, none_without_a_column_nor_when_none_is_asked_for) {
  BoxRoom room;
  const auto scan = scan_room(room);
  stages::SuperclusterOptions none;
  none.min_cylinder_samples = 0;
  EXPECT_TRUE(cylinders_of(scan, room.noise_m, none).empty());
  room.column_radius_m = 0;
  EXPECT_TRUE(cylinders_of(scan_room(room), room.noise_m).empty());
}

// A tunnel of 3 m radius along x about the scanner, two patches of it labelled as planes 1 and 3, and a board
// 30 cm before it as plane 2.
TEST(Cylinders, planes_that_are_patches_of_a_vault_are_forgotten_and_others_are_not) {
  RangeImage image = make_range_image(60, 60);
  PlaneSegmentation segmentation;
  segmentation.square = 5;
  segmentation.square_rows = segmentation.square_cols = 12;
  segmentation.sample_label.assign(image.count(), 0);
  segmentation.square_label.assign(144, 0);
  segmentation.square_class.assign(144, kNonPlanar);
  const auto inside = [](int row, int col, int top, int left) {
    return row >= top && row < top + 5 && col >= left && col < left + 5;
  };
  for (int row = 0; row < 60; ++row)
    for (int col = 0; col < 60; ++col) {
      const std::size_t i = image.index(row, col);
      const std::uint32_t label = inside(row, col, 10, 10)   ? 1
                                  : inside(row, col, 20, 30) ? 2
                                  : inside(row, col, 40, 40) ? 3
                                                             : 0;
      const double el = 1.2 - 0.02 * row, az = std::numbers::pi / 2 + 0.02 * (30 - col);
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const double range = (label == 2 ? 2.7 : 3) / ray.tail<2>().norm();
      image.range_m[i] = static_cast<float>(range);
      image.x[i] = static_cast<float>(range * ray.x());
      image.y[i] = static_cast<float>(range * ray.y());
      image.z[i] = static_cast<float>(range * ray.z());
      image.mask[i] = kMeasured;
      segmentation.sample_label[i] = label;
      segmentation.square_label[static_cast<std::size_t>(row / 5 * 12 + col / 5)] = label;
      if (label != 0)
        segmentation.square_class[static_cast<std::size_t>(row / 5 * 12 + col / 5)] = kSuperclusterMember;
    }
  for (std::uint32_t id = 1; id <= 3; ++id) {
    Supercluster plane;
    plane.id = id;
    plane.samples = 25;
    const std::size_t middle = id == 1   ? image.index(12, 12)
                               : id == 2 ? image.index(22, 32)
                                         : image.index(42, 42);
    plane.centroid_m = image.point(middle);
    plane.plane.normal = -Vec3(0, plane.centroid_m.y(), plane.centroid_m.z()).normalized();
    plane.plane.offset_m = plane.plane.normal.dot(plane.centroid_m);
    segmentation.superclusters.push_back(plane);
  }
  Cylinder tunnel;
  tunnel.foot = {-8, 0, 0};
  tunnel.axis = Vec3::UnitX();
  tunnel.length_m = 16;
  tunnel.radius_m = 3;
  tunnel.samples = 3500;
  tunnel.inside = true;
  segmentation.cylinders = {tunnel};
  stages::RangeNoise noise;
  noise.base_m = 0.001;
  stages::forget_planes_on_cylinders(image, noise, {}, segmentation);
  ASSERT_EQ(segmentation.superclusters.size(), 1u);
  EXPECT_EQ(segmentation.superclusters[0].id, 1u);
  EXPECT_NEAR(segmentation.superclusters[0].centroid_m.tail<2>().norm(), 2.7, 1e-6);
  EXPECT_EQ(segmentation.sample_label[image.index(12, 12)], 0u);
  EXPECT_EQ(segmentation.sample_label[image.index(22, 32)], 1u);
  EXPECT_EQ(segmentation.square_label[2 * 12 + 2], 0u);
  EXPECT_EQ(segmentation.square_class[2 * 12 + 2], kPlanarTooSmall);
  EXPECT_EQ(segmentation.square_class[4 * 12 + 6], kSuperclusterMember);
}

TEST(Cylinders, bad_images_have_none) {
  for (const int side : {1, 3, 40}) {
    RoomScan scan;
    scan.image = make_range_image(side, side);
    for (int k = 0; k < side; ++k) {
      scan.image.elevation_rad[static_cast<std::size_t>(k)] = 0.5 - 0.01 * k;
      scan.image.azimuth_rad[static_cast<std::size_t>(k)] = 0.01 * k;
    }
    EXPECT_TRUE(cylinders_of(scan, 0.002).empty()) << side;
  }
}

}  // namespace hybrid::testing
