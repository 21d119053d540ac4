#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "cases/recess_room.hpp"
#include "device.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::stages::planar_samples_test {
namespace {

using namespace hybrid::testing;

const RecessRoomScan& room() {
  static const RecessRoomScan scan = scan_recess_room(200, 401, 0.002);
  return scan;
}

// Areas by supercluster, found again by its normal and plane.
std::vector<double> areas(const RecessRoomScan& scan, const PlanarSamples& samples) {
  std::vector<double> sums(scan.segmentation.superclusters.size());
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Vec3 p(samples.points[i][0], samples.points[i][1], samples.points[i][2]);
    const Vec3 n(samples.normals[i][0], samples.normals[i][1], samples.normals[i][2]);
    bool found = false;
    for (std::size_t c = 0; c < sums.size() && !found; ++c) {
      const Plane& plane = scan.segmentation.superclusters[c].plane;
      found = std::abs(plane.distance(p)) < 1e-5 && (plane.normal - n).norm() < 1e-6;
      if (found) sums[c] += samples.points[i][3];
    }
    EXPECT_TRUE(found) << "sample " << i << " lies on no supercluster's plane";
  }
  return sums;
}

}  // namespace

TEST(PlanarSamples, weights_are_areas_and_points_lie_on_their_planes) {
  for (int count : {0, 5000}) {
    const auto samples = choose_planar_samples(room().image, room().segmentation, count, 1);
    const auto sums = areas(room(), samples);
    EXPECT_NEAR(sums[0], 48, 0.5);  // the ceiling is met first, and seen whole
    double wall = 0;
    for (std::size_t c = 0; c < sums.size(); ++c) {
      const Plane& plane = room().segmentation.superclusters[c].plane;
      const Vec3 normal = room().world_from_scan.rotate(plane.normal);
      if (normal.x() > 0.99 && std::abs(plane.offset_m + 3.1) < 0.1) wall = sums[c];
    }
    EXPECT_NEAR(wall, 18, 0.2);  // x = 0
  }
}

TEST(PlanarSamples, thinning_keeps_the_area_and_about_the_number_asked_for) {
  const auto all = choose_planar_samples(room().image, room().segmentation, 0, 1);
  double total = 0;
  for (const auto& p : all.points) total += p[3];
  for (int count : {1, 30, 1000, 20000}) {
    const auto some = choose_planar_samples(room().image, room().segmentation, count, 1);
    double sum = 0;
    for (const auto& p : some.points) sum += p[3];
    EXPECT_NEAR(sum, total, 1e-4 * total);
    EXPECT_LE(some.points.size(), static_cast<std::size_t>(count));
    EXPECT_GT(static_cast<double>(some.points.size()), 0.75 * count);
    EXPECT_EQ(some.points.size(), some.normals.size());
  }
  const auto other_seed = choose_planar_samples(room().image, room().segmentation, 1000, 2);
  EXPECT_FALSE(
      same_bits(other_seed.points, choose_planar_samples(room().image, room().segmentation, 1000, 1).points));
}

TEST(PlanarSamples, only_measured_samples_of_superclusters_count) {
  RecessRoomScan scan = room();
  const auto before = choose_planar_samples(scan.image, scan.segmentation, 0, 1).points.size();
  std::size_t gone = 0;
  for (std::size_t i = 0; i < scan.image.count(); i += 7) {
    if (scan.segmentation.sample_label[i] == 0) continue;
    ++gone;
    if (i % 2)
      scan.image.mask[i] = kInterpolated;
    else
      scan.segmentation.sample_label[i] = 0;
  }
  EXPECT_EQ(choose_planar_samples(scan.image, scan.segmentation, 0, 1).points.size(), before - gone);
}

TEST(PlanarSamples, an_image_of_one_row_or_none_works) {
  const RecessRoomScan line = scan_recess_room(1, 100, 0, Vec3::Zero(), {}, 1);
  const auto samples = choose_planar_samples(line.image, line.segmentation, 0, 1);
  EXPECT_EQ(samples.points.size(), 100u);
  for (const auto& p : samples.points) EXPECT_GT(p[3], 0);
  PlaneSegmentation none;
  EXPECT_TRUE(choose_planar_samples(make_range_image(0, 0), none, 100, 1).points.empty());
  none.sample_label.assign(20, 0);
  EXPECT_TRUE(choose_planar_samples(make_range_image(4, 5), none, 100, 1).points.empty());
}

}  // namespace hybrid::stages::planar_samples_test
