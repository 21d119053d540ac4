#include "stages/contours/contours.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "device.hpp"
#include "rings_check.hpp"
#include "stages/box_room.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::testing::contours_test {
namespace {

struct Traced {
  RoomScan scan;
  PlaneSegmentation segmentation;
  std::vector<std::uint8_t> boundary;
};

Traced trace(const BoxRoom& room) {
  Traced t{scan_room(room), {}, {}};
  t.segmentation =
      stages::grow_superclusters(queue(), t.scan.image, fit_squares(t.scan.image, 5, room.noise_m));
  t.boundary = stages::trace_contours(queue(), t.scan.image, t.segmentation);
  return t;
}

const Supercluster& facing(const PlaneSegmentation& segmentation, const Vec3& normal, double offset) {
  for (const Supercluster& s : segmentation.superclusters)
    if (s.plane.normal.dot(normal) > 0.999 && std::abs(s.plane.offset_m - offset) < 0.01) return s;
  ADD_FAILURE() << "no such plane";
  return segmentation.superclusters.front();
}

int count(const Supercluster& s, bool outer) {
  return static_cast<int>(std::count_if(s.contours.begin(), s.contours.end(),
                                        [&](const auto& ring) { return ring.outer == outer; }));
}

void expect_rings(const Supercluster& s, int outer, int inner) {
  EXPECT_EQ(count(s, true), outer) << s.id;
  EXPECT_EQ(count(s, false), inner) << s.id;
}

// Every wall is one ring; the niche and the panel are holes of theirs, the tripod's blind spot one of the
// floor.
void expect_room(const PlaneSegmentation& segmentation) {
  expect_rings(facing(segmentation, {0, 0, -1}, -1.35), 1, 0);  // the ceiling: all azimuths and the zenith
  expect_rings(facing(segmentation, {0, 0, 1}, -1.6), 1, 1);
  expect_rings(facing(segmentation, {1, 0, 0}, -2.6), 1, 0);  // across the seam
  expect_rings(facing(segmentation, {0, -1, 0}, -2.3), 1, 0);
  expect_rings(facing(segmentation, {0, 1, 0}, -2.9), 1, 1);
  expect_rings(facing(segmentation, {-1, 0, 0}, -3.4), 1, 1);
  expect_rings(facing(segmentation, {-1, 0, 0}, -3.37), 1, 0);
}

// A scanner in front of the wall x = 2, 20 mm between samples.
RangeImage wall_image(int rows, int cols) {
  RangeImage image = make_range_image(rows, cols);
  for (int row = 0; row < rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = 0.01 * (rows / 2 - row);
  for (int col = 0; col < cols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = 0.01 * (col - cols / 2);
  for (std::size_t i = 0; i < image.count(); ++i) {
    const double el = image.elevation_rad[i / static_cast<std::size_t>(cols)];
    const double az = image.azimuth_rad[i % static_cast<std::size_t>(cols)];
    const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
    const Vec3 p = 2 / ray.x() * ray;
    image.x[i] = static_cast<float>(p.x());
    image.y[i] = static_cast<float>(p.y());
    image.z[i] = static_cast<float>(p.z());
    image.range_m[i] = static_cast<float>(p.norm());
    image.mask[i] = kMeasured;
  }
  return image;
}

PlaneSegmentation wall_of(const RangeImage& image, const auto& inside) {
  PlaneSegmentation segmentation;
  segmentation.superclusters.resize(1);
  segmentation.superclusters[0].id = 1;
  segmentation.superclusters[0].plane = {Vec3(-1, 0, 0), -2};
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) segmentation.sample_label.push_back(inside(row, col) ? 1 : 0);
  return segmentation;
}

}  // namespace

TEST(Contours, box_room_has_the_rings_of_its_walls) {
  const auto t = trace({});
  expect_room(t.segmentation);
  for (const Supercluster& s : t.segmentation.superclusters)
    // Half a sample is lost all round: much of a jamb or a post, which are few samples across.
    EXPECT_NEAR(expect_valid_contours(s), s.area_m2, (s.area_m2 < 1 ? 0.4 : 0.08) * s.area_m2);
}

TEST(Contours, rings_reach_the_corners_of_a_wall) {
  const auto t = trace({});
  const Supercluster& west = facing(t.segmentation, {1, 0, 0}, -2.6);
  for (const Vec3& corner : {Vec3(-2.6, -2.9, -1.6), Vec3(-2.6, -2.9, 1.35)}) {
    double least = 1;
    for (const Vec3& p : west.contours.at(0).points) least = std::min(least, (p - corner).norm());
    EXPECT_LT(least, 0.06);  // samples lie 3 cm apart there
  }
}

TEST(Contours, dropouts_make_no_rings) {
  BoxRoom room;
  room.dropouts = 0.05;
  const auto t = trace(room);
  expect_room(t.segmentation);
  for (const Supercluster& s : t.segmentation.superclusters) expect_valid_contours(s);
}

TEST(Contours, rings_of_directions_off_the_grid_are_simple) {
  BoxRoom room;
  room.jitter = 0.6;  // neighbours change places
  const auto t = trace(room);
  EXPECT_GE(t.segmentation.superclusters.size(), 8u);
  for (const Supercluster& s : t.segmentation.superclusters) {
    EXPECT_GT(expect_valid_contours(s), (s.area_m2 < 1 ? 0.6 : 0.8) * s.area_m2);
    EXPECT_GE(count(s, true), 1);
  }
}

TEST(Contours, contour_points_lie_on_the_rays_of_boundary_samples) {
  const auto t = trace({});
  std::vector<Vec3> rays;
  for (std::size_t i = 0; i < t.boundary.size(); ++i) {
    if (!t.boundary[i]) continue;
    EXPECT_NE(t.segmentation.sample_label[i], 0u);
    EXPECT_EQ(t.scan.image.mask[i], kMeasured);
    rays.push_back(t.scan.image.point(i).normalized());
  }
  std::size_t points = 0;
  for (const Supercluster& s : t.segmentation.superclusters)
    for (const ContourRing& ring : s.contours) points += ring.points.size();
  EXPECT_LE(points, rays.size());
  EXPECT_LT(rays.size(), 2 * points);  // boundaries are thin
  for (const ContourRing& ring : facing(t.segmentation, {-1, 0, 0}, -3.37).contours)
    for (const Vec3& p : ring.points) {
      double best = 0;
      for (const Vec3& ray : rays) best = std::max(best, ray.dot(p.normalized()));
      EXPECT_GT(best, 1 - 1e-12);
    }
}

TEST(Contours, parts_one_sample_wide_have_no_ring_but_are_boundary) {
  const RangeImage image = wall_image(40, 60);
  auto wall = wall_of(image, [](int row, int col) {
    return (row >= 10 && row < 30 && col >= 5 && col < 25) || (row == 20 && col >= 25 && col < 50) ||
           (row >= 12 && row < 28 && col >= 50 && col < 58);
  });
  const auto boundary = stages::trace_contours(queue(), image, wall);
  expect_rings(wall.superclusters[0], 2, 0);
  EXPECT_NEAR(expect_valid_contours(wall.superclusters[0]), (19 * 19 + 15 * 7) * 4e-4,
              0.015);  // wider off axis
  for (int col = 25; col < 50; ++col) EXPECT_EQ(boundary[image.index(20, col)], 1);
  EXPECT_EQ(boundary[image.index(20, 12)], 0);
}

TEST(Contours, mask_at_the_border_is_closed_along_it) {
  const RangeImage image = wall_image(21, 31);
  auto wall = wall_of(image, [](int, int) { return true; });
  const auto boundary = stages::trace_contours(queue(), image, wall);
  expect_rings(wall.superclusters[0], 1, 0);
  EXPECT_EQ(wall.superclusters[0].contours[0].points.size(), 2u * (20 + 30));
  EXPECT_EQ(std::count(boundary.begin(), boundary.end(), 1), 2 * (20 + 30));
  expect_valid_contours(wall.superclusters[0]);
}

TEST(Contours, specks_keep_their_samples) {
  const RangeImage image = wall_image(30, 30);
  auto wall = wall_of(image, [](int row, int col) { return col < 15 || (row == 7 && col == 22); });
  const auto boundary = stages::trace_contours(queue(), image, wall);
  expect_rings(wall.superclusters[0], 1, 0);
  EXPECT_EQ(boundary[image.index(7, 22)], 1);
}

TEST(Contours, same_bytes_for_any_tile_and_thread_count) {
  const BoxRoom room;
  const auto scan = scan_room(room);
  const auto squares = fit_squares(scan.image, 5, room.noise_m);
  const auto segmentation = stages::grow_superclusters(queue(), scan.image, squares);
  const auto run = [&](int tile) {
    PlaneSegmentation copy = segmentation;
    stages::ContourOptions options;
    options.tile = tile;
    const auto boundary = stages::trace_contours(queue(), scan.image, copy, options);
    std::vector<double> numbers(boundary.begin(), boundary.end());
    for (const Supercluster& s : copy.superclusters)
      for (const ContourRing& ring : s.contours)
        for (const Vec3& p : ring.points) numbers.insert(numbers.end(), p.data(), p.data() + 3);
    return numbers;
  };
  const auto expected = run(1024);
  EXPECT_TRUE(same_bits(expected, run(64)));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same_bits(expected, run(100)));
}

TEST(Contours, nothing_comes_of_nothing) {
  for (const auto& [rows, cols] : {std::pair(0, 0), std::pair(1, 1), std::pair(20, 30)}) {
    const auto image = make_range_image(rows, cols);
    PlaneSegmentation segmentation;
    segmentation.sample_label.assign(image.count(), 0);
    EXPECT_EQ(stages::trace_contours(queue(), image, segmentation),
              std::vector<std::uint8_t>(image.count(), 0));
    segmentation.sample_label.push_back(0);
    EXPECT_THROW(stages::trace_contours(queue(), image, segmentation), Error);
  }
}

}  // namespace hybrid::testing::contours_test
