#include "stages/planes/small_planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "device.hpp"
#include "stages/box_room.hpp"

namespace hybrid::testing::small_planes_test {
namespace {

PlaneSegmentation segment_all(const RoomScan& scan, double sigma_m, int least = 48) {
  stages::SuperclusterOptions options;
  options.min_plane_samples = least;
  return stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, 5, sigma_m), options);
}

// Samples of the supercluster with this normal and offset (2 degrees, 1 cm); 0 when there is none or two.
std::int64_t samples_of(const PlaneSegmentation& segmentation, const Vec3& normal, double offset_m) {
  std::int64_t samples = 0;
  for (const Supercluster& s : segmentation.superclusters) {
    if (s.plane.normal.dot(normal) < std::cos(0.035) || std::abs(s.plane.offset_m - offset_m) > 0.01)
      continue;
    if (samples > 0) return 0;
    samples = s.samples;
  }
  return samples;
}

std::int64_t count_truth(const RoomScan& scan, RoomPlane face, bool labelled, const PlaneSegmentation& s) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < scan.truth.size(); ++i)
    count += scan.truth[i] == face && (!labelled || s.sample_label[i] != 0);
  return count;
}

}  // namespace

// Jambs, sill and head of a niche 20 cm deep: 5 to 8 samples wide, no whole square on some.
TEST(SmallPlanes, jambs_of_a_niche_are_found) {
  BoxRoom room;
  room.niche_m = 0.2;
  const auto scan = scan_room(room);
  const auto segmentation = segment_all(scan, room.noise_m);
  std::int64_t found = 0;
  for (const auto& [normal, offset] : {std::pair(Vec3(1, 0, 0), -0.7), std::pair(Vec3(-1, 0, 0), -0.8),
                                       std::pair(Vec3(0, 0, 1), -0.9), std::pair(Vec3(0, 0, -1), -0.6)}) {
    const std::int64_t samples = samples_of(segmentation, normal, offset);
    EXPECT_GT(samples, 60) << normal.transpose();  // measured: 84 of the head, seen at a grazing angle
    found += samples;
  }
  // The panel's edges, 3 cm, are too narrow; everything else is one of the four.
  EXPECT_GT(static_cast<double>(found),
            0.85 * static_cast<double>(count_truth(scan, kSmallFaces, false, segmentation)));
}

// A pane sends back a third of the rays, a third goes on to somewhere behind it, the rest is lost: no square
// and no window of neighbours lies on it.
TEST(SmallPlanes, a_pane_that_most_rays_pass_is_found) {
  BoxRoom room;
  auto scan = scan_room(room);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<std::uint8_t> kept(scan.image.count());
  for (std::size_t i = 0; i < scan.image.count(); ++i) {
    if (scan.truth[i] != kNicheBack) continue;
    const float draw = uniform(random), factor = draw < 0.35f  ? 1
                                                 : draw < 0.7f ? 1.2f + 2 * uniform(random)
                                                               : NAN;
    kept[i] = factor == 1;
    for (auto* values : {&scan.image.x, &scan.image.y, &scan.image.z, &scan.image.range_m})
      (*values)[i] *= factor;
    if (std::isnan(factor)) scan.image.mask[i] = kEmpty;
  }
  const auto segmentation = segment_all(scan, room.noise_m);
  std::map<std::uint32_t, std::int64_t> labels;
  std::int64_t on_pane = 0, behind = 0, behind_labelled = 0;
  for (std::size_t i = 0; i < scan.image.count(); ++i) {
    if (scan.truth[i] != kNicheBack || scan.image.mask[i] == kEmpty) continue;
    on_pane += kept[i];
    behind += !kept[i];
    behind_labelled += !kept[i] && segmentation.sample_label[i] != 0;
    if (kept[i]) ++labels[segmentation.sample_label[i]];
  }
  labels.erase(0);
  std::int64_t most = 0;
  for (const auto& [label, count] : labels) most = std::max(most, count);
  EXPECT_GT(on_pane, 500);
  EXPECT_GT(static_cast<double>(most), 0.95 * static_cast<double>(on_pane));
  EXPECT_LT(static_cast<double>(behind_labelled), 0.02 * static_cast<double>(behind));
}

TEST(SmallPlanes, switched_off_only_superclusters_of_squares_are_left) {
  BoxRoom room;
  room.niche_m = 0.2;
  const auto scan = scan_room(room);
  EXPECT_EQ(segment_all(scan, room.noise_m, 0).superclusters.size(), std::size_t{kScoredPlanes});
}

TEST(SmallPlanes, columns_of_any_thickness_give_none) {
  for (const double radius : {0.05, 0.1, 0.25, 0.6})
    for (const double noise : {0.001, 0.004}) {
      BoxRoom room;
      room.column_radius_m = radius;
      room.noise_m = noise;
      const auto scan = scan_room(room);
      const auto segmentation = segment_all(scan, noise);
      const auto all = static_cast<double>(count_truth(scan, kColumn, false, segmentation));
      const auto planar = static_cast<double>(count_truth(scan, kColumn, true, segmentation));
      EXPECT_LT(planar, 0.01 * all) << radius << " m, noise " << noise;  // where it meets floor and ceiling
    }
}

TEST(SmallPlanes, the_least_number_of_samples_is_kept) {
  BoxRoom room;
  room.niche_m = 0.2;
  const auto scan = scan_room(room);
  const auto all = segment_all(scan, room.noise_m, 48);
  std::int64_t jamb = std::numeric_limits<std::int64_t>::max();
  for (const Supercluster& s : all.superclusters) jamb = std::min(jamb, s.samples);
  EXPECT_GE(jamb, 48);
  const auto fewer = segment_all(scan, room.noise_m, static_cast<int>(2 * jamb));
  EXPECT_LT(fewer.superclusters.size(), all.superclusters.size());
  for (const Supercluster& s : fewer.superclusters) EXPECT_GE(s.samples, 2 * jamb);
}

// The niche straddles the seam when all columns move by a quarter turn.
TEST(SmallPlanes, the_azimuth_seam_cuts_none) {
  BoxRoom room;
  room.niche_m = 0.3;
  auto scan = scan_room(room);
  const auto expected = segment_all(scan, room.noise_m);
  const auto turn = [&](auto& values) {
    for (int row = 0; row < room.rows; ++row) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(scan.image.index(row, 0));
      std::rotate(first, first + room.cols / 4, first + room.cols);
    }
  };
  turn(scan.image.x);
  turn(scan.image.y);
  turn(scan.image.z);
  turn(scan.image.mask);
  turn(scan.image.range_m);
  turn(scan.truth);
  const auto turned = segment_all(scan, room.noise_m);
  EXPECT_EQ(turned.superclusters.size(), expected.superclusters.size());
  for (const auto& [normal, offset] : {std::pair(Vec3(1, 0, 0), -0.7), std::pair(Vec3(0, 0, 1), -0.9)}) {
    const auto whole = static_cast<double>(samples_of(expected, normal, offset));
    EXPECT_GT(whole, 100);
    EXPECT_NEAR(static_cast<double>(samples_of(turned, normal, offset)), whole, 0.1 * whole);
  }
}

TEST(SmallPlanes, ranges_at_random_hold_none) {
  BoxRoom room;
  auto scan = scan_room(room);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.5f, 2);
  for (std::size_t i = 0; i < scan.image.count(); ++i) {
    const float factor = uniform(random);
    for (auto* values : {&scan.image.x, &scan.image.y, &scan.image.z, &scan.image.range_m})
      (*values)[i] *= factor;
  }
  EXPECT_TRUE(segment_all(scan, room.noise_m).superclusters.empty());
}

}  // namespace hybrid::testing::small_planes_test
