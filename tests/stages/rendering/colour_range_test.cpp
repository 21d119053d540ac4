#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/room_scene.hpp"
#include "device.hpp"

namespace hybrid::testing {
namespace {

// A scan of the room without noise; every 11th node is empty, every 17th interpolated.
struct RoomScan {
  RangeImage image;
  Pose world_from_scan;
  std::vector<std::uint32_t> face;  // 1 + face per node

  static RoomScan make(const RoomScene& room, int rows, int cols) {
    RoomScan scan;
    scan.image = make_range_image(rows, cols);
    scan.image.wraps = true;
    scan.world_from_scan.rotation = Eigen::AngleAxisd(0.3, Vec3::UnitZ());
    scan.world_from_scan.translation = Vec3(1.5, 3.6, 1.4);
    scan.face.assign(scan.image.count(), 0);
    for (int r = 0; r < rows; ++r)
      scan.image.elevation_rad[static_cast<std::size_t>(r)] = 1.2 - 2.2 * r / (rows - 1);
    for (int c = 0; c < cols; ++c)
      scan.image.azimuth_rad[static_cast<std::size_t>(c)] = 2 * std::numbers::pi * c / cols;
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < cols; ++c) {
        const std::size_t i = scan.image.index(r, c);
        if (i % 11 == 10) continue;
        const double el = scan.image.elevation_rad[static_cast<std::size_t>(r)];
        const double az = scan.image.azimuth_rad[static_cast<std::size_t>(c)];
        const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
        const auto [id, range] = room.hit(scan.world_from_scan.translation, scan.world_from_scan.rotate(ray));
        scan.image.range_m[i] = static_cast<float>(range);
        scan.image.x[i] = static_cast<float>(range * ray.x());
        scan.image.y[i] = static_cast<float>(range * ray.y());
        scan.image.z[i] = static_cast<float>(range * ray.z());
        scan.image.mask[i] = i % 17 == 16 ? kInterpolated : kMeasured;
        scan.face[i] = id;
      }
    return scan;
  }
};

}  // namespace

TEST(ColourRange, gives_samples_their_true_colour_and_a_flag) {
  const RoomScene room = RoomScene::make(4, 240, 180);
  const RoomScan scan = RoomScan::make(room, 90, 240);
  stages::Renderer renderer(queue(), room.scene);
  const auto got = renderer.colour_range_image(scan.image, {}, scan.world_from_scan);
  std::size_t seen = 0, red = 0, wrong = 0;
  for (std::size_t i = 0; i < scan.image.count(); ++i) {
    const float* rgb = got.colour.pixels.data() + 3 * i;
    if (scan.image.mask[i] != kMeasured) {
      EXPECT_TRUE(std::isnan(rgb[0]) && got.coverage[i] == 0);
      continue;
    }
    if (got.coverage[i] == 0) {
      ++red;
      EXPECT_TRUE(rgb[0] == 1 && rgb[1] == 0 && rgb[2] == 0);
      continue;
    }
    ++seen;
    const Vec3 truth = RoomScene::paint(scan.face[i], scan.world_from_scan * scan.image.point(i));
    for (int k = 0; k < 3; ++k)
      if (std::abs(rgb[k] - truth[k]) > 0.08) {
        ++wrong;
        break;
      }
  }
  EXPECT_GT(seen, 12000u);
  EXPECT_GT(red, 500u);
  EXPECT_LT(static_cast<double>(wrong), 0.03 * static_cast<double>(seen));

  const auto tiled = renderer.colour_range_image(scan.image, {}, scan.world_from_scan, 32);
  EXPECT_TRUE(same_bits(got.colour.pixels, tiled.colour.pixels));
  EXPECT_EQ(got.coverage, tiled.coverage);
}

TEST(ColourRange, an_image_without_samples_has_no_colours) {
  const RoomScene room = RoomScene::make(1, 24, 18);
  stages::Renderer renderer(queue(), room.scene);
  const auto empty = renderer.colour_range_image(make_range_image(3, 4), {}, {});
  for (float value : empty.colour.pixels) EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(renderer.colour_range_image(make_range_image(0, 0), {}, {}).coverage.empty());
}

TEST(Splats, stand_for_the_measured_samples_kept_and_close_up) {
  const RoomScene room = RoomScene::make(0, 24, 18);
  const RoomScan scan = RoomScan::make(room, 180, 480);
  std::vector<std::uint8_t> keep(scan.image.count(), 1);
  for (std::size_t i = 0; i < keep.size(); i += 2) keep[i] = 0;
  const auto half = stages::make_splats(scan.image, {}, keep, scan.world_from_scan, 2);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i] || scan.image.mask[i] != kMeasured) continue;
    const Vec3f at = (scan.world_from_scan * scan.image.point(i)).cast<float>();
    EXPECT_EQ(half.at(kept++).centre_m, (std::array<float, 3>{at.x(), at.y(), at.z()}));
  }

  // Whatever follows stands for nodes without a sample.
  const auto measured = std::count(scan.image.mask.begin(), scan.image.mask.end(), kMeasured);
  EXPECT_LE(half.size() - kept, scan.image.count() - static_cast<std::size_t>(measured));

  std::fill(keep.begin(), keep.end(), std::uint8_t{1});
  stages::RenderScene scene;
  scene.splats = stages::make_splats(scan.image, {}, keep, scan.world_from_scan, 2);
  float farthest = 0;
  for (const float range : scan.image.range_m)
    if (range > farthest) farthest = range;
  for (const auto& splat : scene.splats) {
    EXPECT_EQ(splat.scan, 2u);
    EXPECT_GT(splat.radius_m, 0);
    EXPECT_LT(splat.radius_m, 0.5 * farthest * 0.0131 * std::numbers::sqrt2 * 4);
  }
  // Seen from the scanner a wall of spheres has holes only where samples are missing. So has one of every
  // third row and column, in spheres that are as many times larger.
  const auto thinned = stages::make_splats(scan.image, {}, keep, scan.world_from_scan, 2, 3);
  std::size_t next = 0, of_these = 0;
  for (int row = 0; row < scan.image.rows; ++row)
    for (int col = 0; col < scan.image.cols; ++col) {
      if (scan.image.mask[scan.image.index(row, col)] != kMeasured) continue;
      const auto& splat = scene.splats.at(next++);
      if (row % 3 != 0 || col % 3 != 0) continue;
      const auto& larger = thinned.at(of_these++);
      EXPECT_EQ(larger.centre_m, splat.centre_m);
      EXPECT_FLOAT_EQ(larger.radius_m, 3 * splat.radius_m);
    }
  EXPECT_EQ(of_these, thinned.size());
  EXPECT_GT(scene.splats.size(), next);  // gaps between them
  stages::ViewRequest request;
  request.camera = look_at(scan.world_from_scan.translation, Vec3(0, 2, 1.4), {0, 0, 1}, 50, 200, 150);
  request.texture = false;
  const auto view = stages::Renderer(queue(), scene).render(request);
  const auto holes = std::count(view.id.begin(), view.id.end(), 0u);
  EXPECT_LT(static_cast<double>(holes), 0.1 * 200 * 150);
}

// The wall x = 2, on plane 1 left of the middle and on none right of it.
struct GapsInAWall {
  RangeImage image = make_range_image(9, 21);
  PlaneSegmentation segmentation;
  std::vector<std::uint8_t> drawn;

  GapsInAWall() : drawn(image.count(), stages::kDrawn) {
    segmentation.sample_label.assign(image.count(), 0);
    for (int r = 0; r < 9; ++r) image.elevation_rad[static_cast<std::size_t>(r)] = 0.02 * (4 - r);
    for (int c = 0; c < 21; ++c) image.azimuth_rad[static_cast<std::size_t>(c)] = 0.02 * (c - 10);
    for (int r = 0; r < 9; ++r)
      for (int c = 0; c < 21; ++c) {
        const std::size_t i = image.index(r, c);
        const double y = 2 * std::tan(0.02 * (c - 10)), z = std::hypot(2, y) * std::tan(0.02 * (4 - r));
        image.x[i] = 2;
        image.y[i] = static_cast<float>(y);
        image.z[i] = static_cast<float>(z);
        image.range_m[i] = static_cast<float>(Vec3(2, y, z).norm());
        image.mask[i] = kMeasured;
        segmentation.sample_label[i] = c < 10 ? 1 : 0;
      }
    segmentation.superclusters.resize(1);
    segmentation.superclusters[0].id = 1;
    segmentation.superclusters[0].plane = {{-1, 0, 0}, -2};
  }

  void lose(int row, int from, int to) {
    for (int col = from; col <= to; ++col) image.mask[image.index(row, col)] = kEmpty;
  }
  std::size_t gaps() const {
    std::size_t samples = 0;
    for (std::size_t i = 0; i < image.count(); ++i) samples += image.mask[i] == kMeasured && drawn[i];
    return stages::make_splats(image, segmentation, drawn, {}, 0).size() - samples;
  }
};

TEST(Splats, are_no_larger_than_their_limits) {
  const GapsInAWall wall;
  const auto whole = stages::make_splats(wall.image, wall.segmentation, wall.drawn, {}, 0);
  const std::uint32_t first = 3, second = 7;
  const auto limited = stages::make_splats(wall.image, wall.segmentation, wall.drawn, {}, 0, 1,
                                           {{first, 0.25f * whole[first].radius_m}, {second, 1.0f}});
  ASSERT_EQ(limited.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i)
    EXPECT_FLOAT_EQ(limited[i].radius_m, (i == first ? 0.25f : 1.0f) * whole[i].radius_m) << i;
}

TEST(Splats, close_what_is_missing_between_samples_of_one_surface) {
  GapsInAWall wall;
  EXPECT_EQ(wall.gaps(), 0u);
  wall.lose(4, 5, 5);
  ASSERT_EQ(wall.gaps(), 1u);
  const stages::Splat gap = stages::make_splats(wall.image, wall.segmentation, wall.drawn, {}, 0).back();
  EXPECT_NEAR(gap.centre_m[0], 2, 1e-6);
  EXPECT_NEAR(gap.centre_m[1], wall.image.y[wall.image.index(4, 5)], 1e-3);
  EXPECT_NEAR(gap.centre_m[2], wall.image.z[wall.image.index(4, 5)], 1e-3);
  EXPECT_GT(gap.radius_m, 0.02);
  // Three nodes each way of a plane are still a gap, more are an opening; of no plane one.
  const auto lost = [](int first, int last, int from, int to) {
    GapsInAWall holed;
    for (int row = first; row <= last; ++row) holed.lose(row, from, to);
    return holed.gaps();
  };
  EXPECT_EQ(lost(3, 5, 3, 5), 9u);
  EXPECT_EQ(lost(2, 6, 2, 6), 0u);
  EXPECT_EQ(lost(4, 4, 15, 15), 1u);
  EXPECT_EQ(lost(3, 4, 14, 15), 0u);
}

TEST(Splats, close_nothing_between_two_surfaces) {
  GapsInAWall step;  // half a metre deep
  for (int r = 0; r < 9; ++r)
    for (int c = 12; c < 21; ++c) step.image.x[step.image.index(r, c)] = 2.5f;
  for (int r = 0; r < 9; ++r) step.lose(r, 11, 11);
  EXPECT_EQ(step.gaps(), 0u);
  GapsInAWall plane;  // ends where nothing tells its label
  for (int r = 0; r < 9; ++r) plane.lose(r, 10, 10);
  EXPECT_EQ(plane.gaps(), 0u);
  GapsInAWall hidden;  // what is not drawn beside a gap leaves it
  hidden.lose(4, 5, 5);
  for (const std::size_t i : {hidden.image.index(4, 4), hidden.image.index(3, 5)})
    hidden.drawn[i] = stages::kNotDrawn;
  EXPECT_EQ(hidden.gaps(), 0u);
}

}  // namespace hybrid::testing
