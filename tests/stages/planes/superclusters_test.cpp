#include "stages/planes/superclusters.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "device.hpp"
#include "stages/box_room.hpp"

namespace hybrid::testing::superclusters_test {
namespace {

PlaneSegmentation segment(const RoomScan& scan, double sigma, const stages::SuperclusterOptions& options = {},
                          int square = 5) {
  return stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, square, sigma), options);
}

// Truth of the room's faces in the scan frame: normal and offset.
Plane true_plane(std::size_t face) {
  switch (face) {
    case kFloor:
      return {Vec3(0, 0, 1), -1.6};
    case kCeiling:
      return {Vec3(0, 0, -1), -1.35};
    case kWallEast:
      return {Vec3(-1, 0, 0), -3.4};
    case kWallWest:
      return {Vec3(1, 0, 0), -2.6};
    case kWallNorth:
      return {Vec3(0, -1, 0), -2.3};
    case kWallSouth:
      return {Vec3(0, 1, 0), -2.9};
    case kPanel:
      return {Vec3(-1, 0, 0), -3.37};
    default:
      return {Vec3(0, 1, 0), -3.3};
  }
}

bool same(const PlaneSegmentation& a, const PlaneSegmentation& b) {
  if (a.superclusters.size() != b.superclusters.size()) return false;
  for (std::size_t i = 0; i < a.superclusters.size(); ++i) {
    const Supercluster &s = a.superclusters[i], &t = b.superclusters[i];
    if (s.plane.normal != t.plane.normal || s.plane.offset_m != t.plane.offset_m || s.rms_m != t.rms_m ||
        s.area_m2 != t.area_m2 || s.centroid_m != t.centroid_m || s.samples != t.samples ||
        s.squares != t.squares)
      return false;
  }
  return a.sample_label == b.sample_label && a.square_label == b.square_label &&
         a.square_class == b.square_class;
}

}  // namespace

TEST(Superclusters, box_room_gives_exactly_its_planes) {
  for (const double noise : {0.0005, 0.002, 0.004}) {
    BoxRoom room;
    room.noise_m = noise;
    const auto scan = scan_room(room);
    const auto segmentation = segment(scan, noise);
    const auto result = score_room(scan, segmentation);
    EXPECT_EQ(result.found, kScoredPlanes) << noise;
    EXPECT_GT(result.right, 0.995) << noise;  // measured: 0.9999, 0.9993, 0.9979
    EXPECT_LT(result.curved_planar, 0.01) << noise;
    // No scored plane twice, and nothing else but the room's small faces: edges of the panel, jambs, the
    // post.
    std::multiset<std::size_t> faces(result.majority.begin(), result.majority.end());
    faces.erase(kSmallFaces);
    EXPECT_EQ(faces.size(), std::size_t{kScoredPlanes}) << noise;
    EXPECT_EQ(std::set<std::size_t>(faces.begin(), faces.end()).size(), std::size_t{kScoredPlanes}) << noise;
    EXPECT_FALSE(faces.contains(kColumn)) << noise;
  }
}

TEST(Superclusters, dense_scan_with_its_slivers_near_the_zenith) {
  BoxRoom room;
  room.rows = 600;
  room.cols = 1440;
  const auto scan = scan_room(room);
  const auto segmentation = segment(scan, room.noise_m);
  const auto result = score_room(scan, segmentation);
  EXPECT_EQ(result.found, kScoredPlanes);
  EXPECT_GT(result.right, 0.995);  // measured: 0.9995; without absorb_squares 0.915
  EXPECT_LT(result.curved_planar, 0.01);
  for (const std::size_t face : result.majority) EXPECT_NE(face, std::size_t{kColumn});
}

// Regression: large squares straddle the corner of floor and wall with a slight, consistent tilt, which once
// made a facet of the whole floor.
// A barrel vault of 2.8 m, 7.6 m above the scanner, a hundred megapixels around: columns are closer to each
// other than their noise, and vertical planes through them fit it. Nothing of it is a plane.
TEST(Superclusters, a_vault_straight_above_gives_no_planes_along_the_line_of_sight) {
  constexpr double kStep_rad = 0.0004, kRadius_m = 2.8, kTop_m = 7.6, kSigma_m = 0.0022;
  RoomScan scan;
  scan.image = make_range_image(400, 800);
  RangeImage& image = scan.image;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, kSigma_m);
  for (int row = 0; row < image.rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = std::numbers::pi / 2 - kStep_rad * (row + 0.5);
  for (int col = 0; col < image.cols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = kStep_rad * (col + 0.5);
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      // |(y, z - axis)| = radius
      const double axis = kTop_m - kRadius_m, across = ray.y() * ray.y() + ray.z() * ray.z(),
                   half = axis * ray.z() / across;
      const double range =
          half + std::sqrt(half * half - (axis * axis - kRadius_m * kRadius_m) / across) + noise(random);
      image.range_m[i] = static_cast<float>(range);
      image.x[i] = static_cast<float>(range * ray.x());
      image.y[i] = static_cast<float>(range * ray.y());
      image.z[i] = static_cast<float>(range * ray.z());
      image.mask[i] = kMeasured;
    }
  for (const Supercluster& s : segment(scan, kSigma_m, {}, 16).superclusters)
    EXPECT_LT(s.plane.normal.dot(s.centroid_m.normalized()), -0.1) << s.samples << " samples";
}

TEST(Superclusters, large_squares_that_straddle_corners_make_no_facet_of_the_floor) {
  BoxRoom room;
  room.full_turn = false;
  room.rows = 900;
  room.cols = 1850;
  room.highest_deg = -12;
  const auto scan = scan_room(room);
  const auto segmentation = segment(scan, room.noise_m, {}, 16);
  ASSERT_FALSE(segmentation.superclusters.empty());
  EXPECT_NEAR(segmentation.superclusters[0].plane.offset_m, -1.6, 1e-3);
  EXPECT_GT(score_room(scan, segmentation).right, 0.99);
}

TEST(Superclusters, planes_are_accurate_and_described) {
  const BoxRoom room;
  const auto scan = scan_room(room);
  const auto segmentation = segment(scan, room.noise_m);
  const auto faces = score_room(scan, segmentation).majority;
  std::int64_t before = std::numeric_limits<std::int64_t>::max();
  std::vector<std::int64_t> labelled(segmentation.superclusters.size() + 1, 0);
  for (const std::uint32_t label : segmentation.sample_label) labelled[label] += 1;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Supercluster& s = segmentation.superclusters[i];
    EXPECT_EQ(s.id, i + 1);
    if (faces[i] == kSmallFaces) continue;  // several planes, which true_plane does not tell apart
    const Plane truth = true_plane(faces[i]);
    EXPECT_LE(s.samples, before);
    before = s.samples;
    EXPECT_EQ(s.samples, labelled[i + 1]);
    EXPECT_LT(s.plane.offset_m, 0);  // the normal looks at the scanner
    EXPECT_LT(s.plane.normal.cross(truth.normal).norm(), 5e-4) << faces[i];
    EXPECT_GT(s.plane.normal.dot(truth.normal), 0) << faces[i];
    // Thousands of samples of 2 mm: well below a tenth of a millimetre; the niche's labels are cut at its
    // rim.
    EXPECT_NEAR(s.plane.offset_m, truth.offset_m, 5e-4) << faces[i];
    EXPECT_LT(s.rms_m, 0.0025);
    EXPECT_GT(s.rms_m, 0.001);
    EXPECT_NEAR(s.plane.distance(s.centroid_m), 0, 5e-4);
    EXPECT_EQ(s.squares,
              std::count(segmentation.square_label.begin(), segmentation.square_label.end(), s.id));
    if (faces[i] == kPanel) {
      EXPECT_NEAR(s.area_m2, 1.9 * 1.5, 0.1);
    }
    if (faces[i] == kCeiling) {
      EXPECT_NEAR(s.area_m2, 6.0 * 5.2 - 0.19, 1.0);  // the column hides some
    }
  }
}

TEST(Superclusters, classes_say_what_became_of_the_squares) {
  const BoxRoom room;
  auto scan = scan_room(room);
  for (int row = 100; row < 110; ++row)
    for (int col = 0; col < 40; ++col) {
      const std::size_t i = scan.image.index(row, col);
      scan.image.x[i] = scan.image.y[i] = scan.image.z[i] = std::numeric_limits<float>::quiet_NaN();
      scan.image.mask[i] = kEmpty;
    }
  const auto segmentation = segment(scan, room.noise_m);
  std::array<int, 4> count{};
  for (std::size_t i = 0; i < segmentation.square_class.size(); ++i) {
    count[segmentation.square_class[i]] += 1;
    EXPECT_EQ(segmentation.square_class[i] == kSuperclusterMember, segmentation.square_label[i] != 0);
  }
  EXPECT_EQ(count[kUndersampled], 16);
  EXPECT_GT(count[kPlanarTooSmall], 50);  // the column's facets
  EXPECT_GT(count[kNonPlanar], 10);
}

TEST(Superclusters, plane_broken_by_an_occluder_is_one) {
  BoxRoom room;
  room.occluder = true;
  const auto scan = scan_room(room);
  const auto result = score_room(scan, segment(scan, room.noise_m));
  EXPECT_EQ(std::count(result.majority.begin(), result.majority.end(), std::size_t{kWallNorth}), 1);
  EXPECT_EQ(result.found, kScoredPlanes);
}

TEST(Superclusters, coplanar_parts_with_a_view_between_them_stay_two) {
  BoxRoom room;
  room.panel_m = 0.1;
  room.panel_gap_m = 0.4;
  const auto scan = scan_room(room);
  const auto result = score_room(scan, segment(scan, room.noise_m));
  EXPECT_EQ(std::count(result.majority.begin(), result.majority.end(), std::size_t{kPanel}), 2);
}

TEST(Superclusters, noise_free_room) {
  BoxRoom room;
  room.noise_m = 0;
  const auto scan = scan_room(room);
  const auto result = score_room(scan, segment(scan, 0));
  EXPECT_EQ(result.found, kScoredPlanes);
  EXPECT_GT(result.right, 0.995);
  EXPECT_LT(result.curved_planar, 0.01);
}

TEST(Superclusters, part_of_a_turn_and_other_squares) {
  BoxRoom room;
  room.full_turn = false;
  room.rows = 301;
  room.cols = 347;
  room.highest_deg = 45;
  const auto scan = scan_room(room);
  for (const int square : {4, 7}) {
    const auto result = score_room(scan, segment(scan, room.noise_m, {}, square));
    EXPECT_GT(result.right, 0.99) << square;
  }
}

TEST(Superclusters, same_bytes_for_any_tile_thread_count_and_work_group) {
  BoxRoom room;
  room.rows = 203;
  room.cols = 421;
  const auto scan = scan_room(room);
  const auto squares = fit_squares(scan.image, 5, room.noise_m);
  const auto run = [&](int tile) {
    stages::SuperclusterOptions options;
    options.tile = tile;
    return stages::grow_superclusters(queue(), scan.image, squares, options);
  };
  const auto expected = run(1024);
  EXPECT_TRUE(same(expected, run(64)));
  const auto [a, b] = at_two_work_group_sizes([&] { return run(100); });
  EXPECT_TRUE(same(expected, a));
  EXPECT_TRUE(same(expected, b));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same(expected, run(1024)));
}

TEST(Superclusters, interpolated_nodes_get_labels_but_are_not_counted) {
  const BoxRoom room;
  auto scan = scan_room(room);
  const auto all = segment(scan, room.noise_m);
  for (std::size_t i = 0; i < scan.image.count(); i += 2) scan.image.mask[i] = kInterpolated;
  const auto half = segment(scan, room.noise_m);
  const std::int64_t measured = half.superclusters[0].samples;
  EXPECT_NEAR(static_cast<double>(measured), 0.5 * static_cast<double>(all.superclusters[0].samples), 500);
  EXPECT_GT(std::count(half.sample_label.begin(), half.sample_label.end(), 1u), 2 * measured - 500);
}

TEST(Superclusters, nothing_comes_of_nothing) {
  for (const auto& [rows, cols] : {std::pair(0, 0), std::pair(1, 1), std::pair(40, 60)}) {
    const auto image = make_range_image(rows, cols);
    const auto result = stages::grow_superclusters(queue(), image, fit_squares(image, 5, 0.002));
    EXPECT_TRUE(result.superclusters.empty());
    EXPECT_EQ(result.sample_label, std::vector<std::uint32_t>(image.count(), 0));
    for (const std::uint8_t kind : result.square_class) EXPECT_EQ(kind, kUndersampled);
  }
}

TEST(Superclusters, squares_of_another_image_are_an_error) {
  const auto image = make_range_image(40, 60);
  EXPECT_THROW(stages::grow_superclusters(queue(), make_range_image(41, 60), fit_squares(image, 5, 0.002)),
               Error);
}

TEST(Superclusters, options_have_names_and_defaults_in_range) {
  stages::SuperclusterOptions options;
  for (const auto& row : stages::supercluster_option_table()) {
    const double value = row.name == "min_squares" || row.name == "tile" ? 20 : row.minimum;
    EXPECT_LT(row.minimum, row.maximum) << row.name;
    if (std::holds_alternative<int stages::SuperclusterOptions::*>(row.member))
      set_option(options, row, static_cast<std::int64_t>(value));
    else
      set_option(options, row, value);
  }
  EXPECT_EQ(options.angle_deg, 0.1);
  set_option(options, *find_option(stages::supercluster_option_table(), "min_squares"), std::int64_t{7});
  EXPECT_EQ(options.min_squares, 7);
}

}  // namespace hybrid::testing::superclusters_test
