// What the chain from range image to decimated samples owes to every scan: how the scanner stood, a mirror
// and how the work is cut up change nothing that matters.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/contours/contours.hpp"
#include "stages/planes/decimate.hpp"
#include "stages/planes/square_planes.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::testing::plane_properties_test {
namespace {

struct Result {
  RoomScore score;
  std::size_t superclusters = 0;
  double discarded = 0, area_m2 = 0;
};

Result process(const RoomScan& scan, int tile = 1024) {
  stages::SquarePlaneOptions square_options;
  stages::SuperclusterOptions supercluster_options;
  stages::ContourOptions contour_options;
  stages::DecimateOptions decimate_options;
  square_options.tile = supercluster_options.tile = contour_options.tile = decimate_options.tile = tile;
  const auto squares = stages::fit_square_planes(queue(), scan.image, square_options);
  auto segmentation = stages::grow_superclusters(queue(), scan.image, squares, supercluster_options);
  const auto boundary = stages::trace_contours(queue(), scan.image, segmentation, contour_options);
  const auto decimation = stages::decimate(queue(), scan.image, segmentation, boundary, decimate_options);
  Result result{score_room(scan, segmentation), segmentation.superclusters.size(),
                decimation.discarded_share(), 0};
  for (const auto& plane : segmentation.superclusters) {
    result.area_m2 += plane.area_m2;
    EXPECT_TRUE(plane.plane.normal.allFinite());
    EXPECT_LT(plane.plane.offset_m, 0);  // towards the scanner
  }
  return result;
}

// Statistically equal: the noise and the test planes are others.
void expect_alike(const Result& a, const Result& b) {
  EXPECT_EQ(a.score.found, kScoredPlanes);
  EXPECT_EQ(b.score.found, kScoredPlanes);
  EXPECT_NEAR(a.score.right, b.score.right, 0.002);
  EXPECT_NEAR(a.score.curved_planar, b.score.curved_planar, 0.002);
  EXPECT_NEAR(a.discarded, b.discarded, 0.01);
  EXPECT_NEAR(a.area_m2 / b.area_m2, 1, 0.01);
}

// Columns in reverse order, y negated: the room in a mirror.
RoomScan mirrored(const RoomScan& scan) {
  RoomScan result = scan;
  auto& image = result.image;
  for (int col = 0; col < image.cols; ++col) {
    const int from = image.cols - 1 - col;
    image.azimuth_rad[static_cast<std::size_t>(col)] =
        -scan.image.azimuth_rad[static_cast<std::size_t>(from)];
    for (int row = 0; row < image.rows; ++row) {
      const std::size_t to = image.index(row, col), at = image.index(row, from);
      image.range_m[to] = scan.image.range_m[at];
      image.x[to] = scan.image.x[at];
      image.y[to] = -scan.image.y[at];
      image.z[to] = scan.image.z[at];
      image.mask[to] = scan.image.mask[at];
      image.source[to] = scan.image.source[at];
      result.truth[to] = scan.truth[at];
    }
  }
  return result;
}

}  // namespace

TEST(PlaneProperties, however_the_scanner_stood_the_room_is_the_same) {
  BoxRoom room;
  const Result upright = process(scan_room(room));
  EXPECT_GT(upright.score.right, 0.995);
  for (const double yaw_deg : {37.0, 180.0}) {
    room.turned = Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180, Vec3::UnitZ()).toRotationMatrix();
    SCOPED_TRACE(yaw_deg);
    expect_alike(upright, process(scan_room(room)));
  }
}

// The scan reaches the zenith and not the nadir: a tilted one sees other parts of floor and ceiling, so areas
// differ, accuracy does not.
TEST(PlaneProperties, a_tilted_scanner_finds_the_same_planes_as_well) {
  BoxRoom room;
  for (const double tilt_deg : {5.0, 25.0}) {
    room.turned =
        Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180, Vec3(1, 0.3, 0).normalized()).toRotationMatrix();
    const Result tilted = process(scan_room(room));
    EXPECT_EQ(tilted.score.found, kScoredPlanes) << tilt_deg;
    EXPECT_GT(tilted.score.right, 0.995) << tilt_deg;
    EXPECT_LT(tilted.score.curved_planar, 0.002) << tilt_deg;
  }
}

TEST(PlaneProperties, the_room_in_a_mirror_is_as_good) {
  const RoomScan scan = scan_room(BoxRoom{});
  expect_alike(process(scan), process(mirrored(scan)));
}

TEST(PlaneProperties, noise_takes_planes_away_and_adds_none) {
  BoxRoom room;
  room.panel_m = 0;  // within the noise of the last
  for (const double noise_m : {0.0, 0.001, 0.004, 0.008}) {
    room.noise_m = noise_m;
    const Result result = process(scan_room(room));
    EXPECT_GE(result.score.found, kScoredPlanes - 1) << noise_m;  // all but the panel
    EXPECT_GT(result.score.right, 0.99) << noise_m;
    EXPECT_LT(result.score.curved_planar, 0.01) << noise_m;
    EXPECT_LE(result.superclusters, 16u) << noise_m;
  }
}

TEST(PlaneProperties, directions_off_the_grid_and_dropouts_cost_little) {
  BoxRoom room;
  room.jitter = 0.3;
  room.dropouts = 0.1;
  const Result result = process(scan_room(room));
  EXPECT_EQ(result.score.found, kScoredPlanes);
  EXPECT_GT(result.score.right, 0.99);
}

}  // namespace hybrid::testing::plane_properties_test
