#include "stages/rendering/curtains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "device.hpp"
#include "stages/rendering/column_backs.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::testing {
namespace {

using stages::Curtain;
using stages::CurtainOptions;
using stages::CurtainScan;

constexpr double kStep_rad = 0.01;

// What a scanner that looks along +y sees, 80 x 120 nodes; `range` of a direction.
RangeImage scan_of(const std::function<double(const Vec3&)>& range) {
  RangeImage image = make_range_image(80, 120);
  for (int row = 0; row < 80; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = kStep_rad * (39.5 - row);
  for (int col = 0; col < 120; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = std::acos(0.0) + kStep_rad * (col - 59.5);
  for (int row = 0; row < 80; ++row)
    for (int col = 0; col < 120; ++col) {
      const std::size_t i = image.index(row, col);
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const double r = range(ray);
      image.range_m[i] = static_cast<float>(r);
      image.x[i] = static_cast<float>(r * ray.x());
      image.y[i] = static_cast<float>(r * ray.y());
      image.z[i] = static_cast<float>(r * ray.z());
      image.mask[i] = kMeasured;
    }
  return image;
}

// A wall at y = 4 and before it, at y = 2, the front of a thing 60 cm wide and high.
double thing_and_wall(const Vec3& ray) {
  const double near = 2 / ray.y();
  return std::abs(near * ray.x()) < 0.3 && std::abs(near * ray.z()) < 0.3 ? near : 4 / ray.y();
}

// The same wall from 3 m farther left, with nothing before it that this scanner sees.
double empty(const Vec3& ray) {
  return 4 / ray.y();
}

}  // namespace

TEST(Curtains, hang_behind_the_outline_of_what_is_near_and_no_farther_than_the_wall) {
  const RangeImage image = scan_of(thing_and_wall);
  for (const double length_m : {0.5, 5.0}) {
    const auto curtains = stages::hang_curtains({{&image, nullptr, nullptr, {}}}, {length_m, 0.02});
    // Its outline is 30 nodes long on each side.
    EXPECT_NEAR(static_cast<double>(curtains.size()), 120, 8);
    for (const Curtain& curtain : curtains)
      for (const Vec3& corner : curtain) {
        const Vec3 at_front = 2 / corner.y() * corner;  // where its ray passes the front
        EXPECT_NEAR(std::max(std::abs(at_front.x()), std::abs(at_front.z())), 0.3, 0.025);
        EXPECT_GT(corner.y(), 1.98);
        EXPECT_LT(corner.norm(), std::min(2.1 + length_m, 4.1));
      }
  }
}

TEST(Curtains, none_where_surfaces_are_one_or_another_scan_saw_through) {
  EXPECT_TRUE(stages::hang_curtains({}).empty());
  const RangeImage wall = scan_of(empty), near = scan_of(thing_and_wall);
  EXPECT_TRUE(stages::hang_curtains({{&wall, nullptr, nullptr, {}}}).empty());
  const std::vector<std::uint32_t> one(near.count(), 1);
  EXPECT_TRUE(stages::hang_curtains({{&near, &one, nullptr, {}}}).empty());
  // One that looks over it and sees the wall through most of the places behind it.
  const auto alone = stages::hang_curtains({{&near, nullptr, nullptr, {}}});
  const Pose beside{1, Eigen::Quaterniond::Identity(), {0.05, 0, 0}};
  const auto together =
      stages::hang_curtains({{&near, nullptr, nullptr, {}}, {&wall, nullptr, nullptr, beside}});
  EXPECT_FALSE(alone.empty());
  EXPECT_TRUE(together.empty());
}

// A column behind a wall that hides it, and scans from the same place that see it or through it.
class ColumnBehindAWall : public ::testing::Test {
 protected:
  ColumnBehindAWall() {
    column.foot = {0, 6, -0.5};
    column.length_m = 1;
    column.radius_m = 0.3;
    columns = {column};
  }

  Cylinder column;
  std::vector<Cylinder> columns;
  RangeImage hiding = scan_of(empty), through = scan_of([](const Vec3&ray) { return 9 / ray.y(); });
};

TEST_F(ColumnBehindAWall, curtains_go_on_beyond_its_ends_where_no_scan_sees_through) {
  const auto curtains = stages::hang_curtains({{&hiding, nullptr, nullptr, {}, &columns}});
  EXPECT_EQ(curtains.size(), 192u);  // 24 sides, 4 slices at either end
  for (const Curtain& curtain : curtains)
    for (const Vec3& corner : curtain) {
      EXPECT_NEAR(column.distance(corner), -0.02, 1e-9);
      EXPECT_GE(std::abs(column.along(corner) - 0.5), 0.5 - 1e-9);
    }
  EXPECT_TRUE(stages::hang_curtains({{&through, nullptr, nullptr, {}, &columns}}).empty());
}

TEST_F(ColumnBehindAWall, its_back_is_what_no_scan_knows) {
  const auto all = stages::column_backs({{&hiding, nullptr, nullptr, {}, &columns}});
  EXPECT_EQ(all.size(), 24u);  // strips from end to end
  for (const auto& back : all) {
    EXPECT_EQ(back.scan, 0u);
    for (const Vec3& corner : back.corners) EXPECT_NEAR(column.distance(corner), 0, 1e-9);
    const auto& c = back.corners;
    EXPECT_GT((c[1] - c[0]).cross(c[3] - c[0]).dot(column.outwards(c[0])), 0);  // front side outwards
  }
  EXPECT_TRUE(
      stages::column_backs({{&hiding, nullptr, nullptr, {}, &columns}, {&through, nullptr, nullptr, {}}})
          .empty());
  // One that sees its front: that is known, the rest is not.
  const RangeImage front = scan_of([&](const Vec3& ray) {
    const double b = ray.head<2>().dot(Vec2(0, 6)), a = ray.head<2>().squaredNorm();
    const double root = b * b - a * (36 - 0.09);
    return root > 0 ? (b - std::sqrt(root)) / a : 9 / ray.y();
  });
  const auto rest = stages::column_backs({{&front, nullptr, nullptr, {}, &columns}});
  // But for strips that it meets at a grazing angle, whose samples are farther apart than the tolerance.
  EXPECT_GE(rest.size(), 12u);
  EXPECT_LE(rest.size(), 16u);
  for (const auto& back : rest) EXPECT_GT(0.5 * (back.corners[0] + back.corners[1]).y(), 6 - 0.3 / 2);
  // Where its front has a hole what is around says that it is seen.
  RangeImage holed = front;
  for (std::size_t i = 0; i < holed.count(); i += 7) holed.mask[i] = kEmpty;
  for (const auto& back : stages::column_backs({{&holed, nullptr, nullptr, {}, &columns}}))
    EXPECT_GT(0.5 * (back.corners[0] + back.corners[1]).y(), 6 - 0.3 / 2);
  columns[0].inside = true;
  EXPECT_TRUE(stages::column_backs({{&hiding, nullptr, nullptr, {}, &columns}}).empty());
}

TEST(Curtains, no_view_looks_through_them) {
  const RangeImage image = scan_of(thing_and_wall);
  stages::RenderScene scene;
  scene.splats =
      stages::make_splats(image, {}, std::vector<std::uint8_t>(image.count(), stages::kDrawn), {}, 0);
  // The photograph looks straight at a piece of the wall, the view at the same piece through the thing.
  const Vec3 piece(-2, 4, 0);
  Photograph before = look_at({-2, 1, 0}, piece, {0, 0, 1}, 40, 96, 96);
  before.name = "before";
  scene.photographs = {before};
  scene.photograph_pixels = {Image8(96, 96, 3, 255)};
  stages::ViewRequest through, beside;
  through.camera = look_at({1, 2.1, 0}, piece, {0, 0, 1}, 3, 24, 24);
  beside.camera = look_at({1, 3, 0}, piece, {0, 0, 1}, 3, 24, 24);
  const auto show = [&](const stages::ViewRequest& request) {
    return stages::Renderer(queue(), scene).render(request);
  };
  const auto open = show(through), open_beside = show(beside);
  scene.curtains = stages::hang_curtains({{&image, nullptr, nullptr, {}}}, {0.6, 0.02});
  const auto closed = show(through), closed_beside = show(beside);
  EXPECT_EQ(closed_beside.colour.pixels, open_beside.colour.pixels);
  EXPECT_EQ(closed.id, open.id);
  EXPECT_EQ(closed.depth_m, open.depth_m);
  for (std::size_t i = 0; i < open.id.size(); ++i) {
    EXPECT_EQ(open.coverage[i], 1u);
    EXPECT_EQ(closed.coverage[i], 0u);
    EXPECT_EQ(closed.best[i], -1);
    EXPECT_EQ(closed.colour.pixels[3 * i], 1);
    EXPECT_EQ(closed.colour.pixels[3 * i + 1], 0);
    EXPECT_EQ(closed.colour.pixels[3 * i + 2], 0);
  }
  through.texture = false;  // plain views show what is there
  const auto plain = show(through);
  scene.curtains.clear();
  EXPECT_EQ(plain.colour.pixels, show(through).colour.pixels);
}

TEST(Curtains, no_photograph_looks_through_them_and_no_view_shows_them) {
  // The front of a column and the wall behind it, as one scan saw them; its back is open.
  const RangeImage image = scan_of(thing_and_wall);
  stages::RenderScene scene;
  scene.splats =
      stages::make_splats(image, {}, std::vector<std::uint8_t>(image.count(), stages::kDrawn), {}, 0);
  // A photograph from the left that sees this piece of the wall only past the front, through the column.
  Photograph left = look_at({-2.5, 0.66, 0}, {2.5, 4, 0}, {0, 0, 1}, 60, 96, 96);
  left.name = "left";
  scene.photographs = {left};
  scene.photograph_pixels = {Image8(96, 96, 3, 255)};
  stages::ViewRequest request;
  request.camera = look_at({2.3, 2.6, 0}, {2.5, 4, 0}, {0, 0, 1}, 10, 48, 48);
  const auto seen = [](const stages::RenderedView& view) {
    return std::count_if(view.coverage.begin(), view.coverage.end(), [](auto n) { return n > 0; });
  };
  const auto open = stages::Renderer(queue(), scene).render(request);
  scene.curtains = stages::hang_curtains({{&image, nullptr, nullptr, {}}}, {0.6, 0.02});
  const auto closed = stages::Renderer(queue(), scene).render(request);
  EXPECT_GT(seen(open), 1000);
  EXPECT_LT(seen(closed), 50);
  // From where the column itself is in the way the wall is still there, red.
  EXPECT_EQ(open.id, closed.id);
  request.camera = look_at({1.5, 2.3, 0}, {-1.5, 2.3, 0}, {0, 0, 1}, 20, 48, 48);
  EXPECT_EQ(stages::Renderer(queue(), scene).render(request).depth_m, [&] {
    scene.curtains.clear();
    return stages::Renderer(queue(), scene).render(request).depth_m;
  }());
}

}  // namespace hybrid::testing
