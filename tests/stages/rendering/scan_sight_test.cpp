#include "stages/rendering/scan_sight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numbers>

#include "stages/rendering/small_scans.hpp"

namespace hybrid::testing::scan_sight_test {
namespace {

using stages::ScanSight;
using stages::SightScan;

// All around, from 80 degrees below to the zenith, on a sphere of 4 m.
RangeImage all_around() {
  RangeImage image = make_range_image(85, 180);
  image.wraps = true;
  for (int row = 0; row < image.rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = (90 - 2.0 * row) * std::numbers::pi / 180;
  for (int col = 0; col < image.cols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = (2.0 * col - 180) * std::numbers::pi / 180;
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      image.range_m[i] = 4;
      image.x[i] = static_cast<float>(4 * std::cos(el) * std::cos(az));
      image.y[i] = static_cast<float>(4 * std::cos(el) * std::sin(az));
      image.z[i] = static_cast<float>(4 * std::sin(el));
      image.mask[i] = i % 5 == 0 ? kEmpty : kMeasured;
    }
  return image;
}

// A scan and one from 3 m farther ahead, by the range that each has in a direction.
struct NearerScan {
  NearerScan(const std::function<double(const Vec3&)>& far, const std::function<double(const Vec3&)>& near)
      : images{scan_of(far), scan_of(near)}, scans(placed(bare_scans(images))), sight(scans, 0.02) {}
  static std::vector<SightScan> placed(std::vector<SightScan> scans) {
    scans[1].world_from_scan.translation = {0, 3, 0};
    return scans;
  }

  const std::vector<RangeImage> images;
  const std::vector<SightScan> scans;
  const ScanSight sight;
};

std::size_t count_near(const RangeImage& image, const Vec3& place, double radius_m) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.count(); ++i)
    count += image.mask[i] == kMeasured && (image.point(i) - place).norm() <= radius_m;
  return count;
}

}  // namespace

TEST(ScanSight, samples_near_a_place_are_those_within_the_radius_wherever_it_is) {
  const RangeImage image = all_around();
  const std::vector<SightScan> scans = {{&image, nullptr, nullptr, {}}};
  const ScanSight sight(scans, 0.02);
  for (const Vec3& place : {Vec3(4, 0, 0), Vec3(-4, 0, 0), Vec3(-4, -0.01, 0.3), Vec3(0, 0, 4),
                            Vec3(0, 0, -3.9), Vec3(1, 1, 3.6), Vec3(0.1, 0, 0), Vec3(0, 0, 0), Vec3(0, 9, 0)})
    for (const double radius_m : {0.3, 1.0, 5.0}) {
      const auto found = sight.samples_near(place, radius_m);
      EXPECT_EQ(found.size(), count_near(image, place, radius_m)) << place.transpose() << ", " << radius_m;
      for (const Vec3& point : found) EXPECT_LE((point - place).norm(), radius_m);
    }
  const auto few = sight.samples_near({4, 0, 0}, 3, 100).size();
  EXPECT_GT(few, 10u);
  EXPECT_LT(few, count_near(image, {4, 0, 0}, 3) / 4);
}

TEST(ScanSight, what_is_at_a_place_before_it_and_behind_it) {
  const RangeImage wall = scan_of(wall_alone);
  std::vector<std::uint8_t> stray(wall.count(), 1);
  const std::vector<SightScan> scans = {{&wall, nullptr, nullptr, {}}},
                               strays = {{&wall, nullptr, &stray, {}}};
  const ScanSight sight(scans, 0.02), blind(strays, 0.02);
  EXPECT_TRUE(sight.is_empty({0, 3, 0}));
  EXPECT_EQ(sight.known({0, 3, 0}), ScanSight::Known::empty);
  EXPECT_FALSE(sight.is_empty({0, 4, 0}));
  EXPECT_EQ(sight.known({0, 4, 0}), ScanSight::Known::yes);
  EXPECT_FALSE(sight.is_empty({0, 5, 0}));
  EXPECT_EQ(sight.known({0, 5, 0}), ScanSight::Known::no);
  EXPECT_EQ(sight.known({0, -3, 0}), ScanSight::Known::no);  // behind the scanner
  EXPECT_FALSE(sight.is_empty({0, 3, 0}, 0));                // by another than the first
  EXPECT_FALSE(blind.is_empty({0, 3, 0}));
  EXPECT_EQ(blind.known({0, 3, 0}), ScanSight::Known::no);
  EXPECT_TRUE(ScanSight({}, 0.02).columns().empty());
}

TEST(ScanSight, seen_through_by_another_scan_all_around_the_place) {
  const auto behind = [](const Vec3& ray) { return 9 / ray.y(); };
  const RangeImage wall = scan_of(wall_alone), far = scan_of(behind),
                   post = scan_of(
                       [&](const Vec3&ray) { return std::abs(ray.x()) < 0.02 ? 3 / ray.y() : behind(ray); });
  const std::vector<SightScan> scans = {{&wall, nullptr, nullptr, {}}, {&far, nullptr, nullptr, {}}},
                               posts = {{&wall, nullptr, nullptr, {}}, {&post, nullptr, nullptr, {}}};
  const ScanSight sight(scans, 0.02), beside(posts, 0.02);
  EXPECT_TRUE(sight.is_seen_through({0, 4, 0}, 0.1, 0.1, 0));
  EXPECT_FALSE(sight.is_seen_through({0, 4, 0}, 5.1, 0.1, 0));                       // by less
  EXPECT_FALSE(sight.is_seen_through({0, 4, 0}, 0.1, 0.1, 1));                       // by itself alone
  EXPECT_FALSE(sight.is_seen_through({0, -4, 0}, 0.1, 0.1, 0));                      // not in sight
  EXPECT_FALSE(sight.is_seen_through({0, 4, 0}, 0.1, 3.9 * kSmallScanStep_rad, 0));  // too coarse for that
  EXPECT_TRUE(sight.is_seen_through({0, 4, 0}, 0.1, 4.1 * kSmallScanStep_rad, 0));
  EXPECT_FALSE(beside.is_seen_through({0, 4, 0}, 0.1, 0.1, 0));
  EXPECT_FALSE(beside.is_seen_through({0.15, 4, 0}, 0.1, 0.1, 0));  // the post is within 10 cm
  EXPECT_FALSE(beside.is_seen_through({0.15, 4, 0.1}, 0.1, 0.1, 0));
  EXPECT_TRUE(beside.is_seen_through({0.3, 4, 0}, 0.1, 0.1, 0));
  EXPECT_FALSE(beside.is_seen_through({0.3, 4, 0}, 0.3, 0.1, 0));
  EXPECT_TRUE(sight.is_hidden({0, 5, 0}, 0));
  EXPECT_FALSE(sight.is_hidden({0, 4, 0}, 0));
  EXPECT_FALSE(sight.is_hidden({0, -5, 0}, 0));
  EXPECT_FALSE(sight.is_hidden({0, 5, 0}, 1));
}

// A wall 4 m ahead; the second scanner stands 3 m nearer to it.
TEST(ScanSight, what_another_scan_shows_with_closer_samples) {
  const NearerScan nearer(wall_alone, [](const Vec3& ray) { return 1 / ray.y(); });
  const ScanSight& sight = nearer.sight;
  const Vec3 place(0.1, 4, 0.1);
  const auto is_seen_finer = [&](const Vec3& at, std::size_t scan, double times) {
    return sight.seen_finer(at, scan, times, 0.5).has_value();
  };
  EXPECT_TRUE(is_seen_finer(place, 0, 2));
  EXPECT_FALSE(sight.seen_finer(place, 0, 2, 0.1)->at_edge);
  EXPECT_NEAR(sight.seen_finer(place, 0, 2, 0.1)->spacing_m, kSmallScanStep_rad * Vec3(0.1, 1, 0.1).norm(),
              1e-9);
  EXPECT_FALSE(is_seen_finer(place, 0, 5));            // it is four times as near
  EXPECT_FALSE(is_seen_finer(place, 1, 2));            // the other one is coarser
  EXPECT_FALSE(is_seen_finer({0.1, 3.9, 0.1}, 0, 2));  // before the wall
  EXPECT_FALSE(is_seen_finer({1.5, 4, 0}, 0, 2));      // beside what the second one sees
}

TEST(ScanSight, at_an_edge_the_coarse_sample_stays) {
  const auto edge = [](double ahead) {
    return [ahead](const Vec3& ray) { return (ahead / ray.y() * ray.x() < 0.2 ? ahead : 9) / ray.y(); };
  };
  const NearerScan nearer(edge(4), edge(1));
  const ScanSight& sight = nearer.sight;
  const auto inside = sight.seen_finer({0.1, 4, 0}, 0, 2, 0.1),
             beside_edge = sight.seen_finer({0.197, 4, 0}, 0, 2, 0.1);
  ASSERT_TRUE(inside && beside_edge);
  EXPECT_FALSE(inside->at_edge);
  EXPECT_TRUE(beside_edge->at_edge);
  EXPECT_NEAR(beside_edge->spacing_m, kSmallScanStep_rad * Vec3(0.197, 1, 0).norm(), 1e-9);
  EXPECT_FALSE(sight.seen_finer({0.197, 4, 0}, 0, 5, 0.1));
}

// The second scanner stands 3 m nearer and sees past a sample of the first; a scan as coarse does not say so.
TEST(ScanSight, a_closer_scan_that_sees_past_a_sample_makes_it_small) {
  const NearerScan nearer(wall_alone, [](const Vec3& ray) { return 1.5 / ray.y(); });
  const ScanSight& sight = nearer.sight;
  const Vec3 place(0.1, 4, 0.1);
  const auto past = sight.seen_finer(place, 0, 2, 0.1);
  ASSERT_TRUE(past.has_value());
  EXPECT_TRUE(past->at_edge);
  EXPECT_NEAR(past->spacing_m, kSmallScanStep_rad * Vec3(0.1, 1, 0.1).norm(), 1e-9);
  EXPECT_FALSE(sight.seen_finer(place, 0, 2, 0.6));  // not by as much
  EXPECT_FALSE(sight.seen_finer(place, 0, 5, 0.1));  // not as much closer together
}

TEST(ScanSight, a_walk_says_of_places_beside_each_other_what_is_said_of_each) {
  const RangeImage wall = scan_of(wall_alone), round = all_around();
  const Pose there{
      1, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vec3(0.1, 0.2, 1).normalized())), {1, 2, 0.5}};
  const std::vector<SightScan> scans = {{&wall, nullptr, nullptr, {}}, {&round, nullptr, nullptr, there}};
  const ScanSight sight(scans, 0.02);
  std::array<int, 3> count{};
  for (const Vec3& step :
       {Vec3(0.02, 0, 0), Vec3(0, -0.03, 0.001), Vec3(0.001, 0, -0.0005), Vec3(0.3, 0.2, -0.1)}) {
    stages::SightWalk walk(sight);
    for (int k = -400; k < 400; ++k) {
      const Vec3 place = Vec3(0.05, 4, 0.3) + k * step;
      const auto known = sight.known(place);
      EXPECT_EQ(walk.known(place), known) << place.transpose();
      ++count[static_cast<std::size_t>(known)];
    }
  }
  for (const int of_kind : count) EXPECT_GT(of_kind, 100);
}

TEST(ScanSight, a_scan_all_around_sees_past_a_place_before_the_sky) {
  RangeImage image = all_around();
  const auto clear_m = [&](const Vec3& place) {
    const std::vector<SightScan> scans = {{&image, nullptr, nullptr, {}}};
    const ScanSight sight(scans, 0.02);
    return std::array{sight.is_empty(place), sight.known(place) != ScanSight::Known::no};
  };
  constexpr std::array kNothing = {false, false}, kClear = {true, true};
  const double low = 20 * std::numbers::pi / 180, high = 40 * std::numbers::pi / 180;
  const Vec3 at_20(std::cos(low), 0, std::sin(low)), at_40(std::cos(high), 0, std::sin(high));
  for (int row = 0; row < 30; ++row)  // 30 degrees above the horizon and more
    for (int col = 0; col < image.cols; ++col) image.mask[image.index(row, col)] = kEmpty;
  EXPECT_EQ(clear_m(3 * at_40), kClear);
  EXPECT_EQ(clear_m(3.9 * at_40), kClear);
  EXPECT_EQ(clear_m(4.1 * at_40), kNothing);  // farther than it has any sample
  EXPECT_EQ(clear_m(5 * at_20), kNothing);    // behind what it sees
  // A window whose glass returns nothing is no sky: there is a wall over it.
  for (int col = 0; col < image.cols; ++col) image.mask[image.index(10, col)] = kMeasured;
  EXPECT_EQ(clear_m(3 * at_40), kNothing);
  for (int col = 0; col < image.cols; ++col) image.mask[image.index(10, col)] = kEmpty;
  // Nor is the next node beside what is there, or a scan that is not all around.
  image.mask[image.index(24, 91)] = kMeasured;
  EXPECT_EQ(clear_m(3 * at_40), kNothing);
  image.mask[image.index(24, 91)] = kEmpty;
  image.wraps = false;
  EXPECT_EQ(clear_m(3 * at_40), kNothing);
}

TEST_F(ColumnBehindAWall, columns_stand_in_the_world) {
  columns.push_back(column);
  columns[1].inside = true;
  const Pose placed{1, Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ())), {1, 2, 3}};
  const std::vector<SightScan> scans = {{&hiding, nullptr, nullptr, {}},
                                        {&hiding, nullptr, nullptr, placed, &columns}};
  const auto found = ScanSight(scans, 0.02).columns();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].scan, 1u);
  EXPECT_LT((found[0].cylinder.foot - Vec3(-5, 2, 2.5)).norm(), 1e-12);
  EXPECT_EQ(found[0].cylinder.radius_m, column.radius_m);
}

}  // namespace hybrid::testing::scan_sight_test
