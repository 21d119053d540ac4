#include "stages/rendering/curtains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "device.hpp"
#include "stages/rendering/render.hpp"
#include "stages/rendering/small_scans.hpp"

namespace hybrid::testing::curtains_test {
namespace {

using stages::Curtain;
using stages::CurtainOptions;
using stages::SightScan;

// A wall at y = 4 and before it, at y = 2, the front of a thing 60 cm wide and high.
double thing_and_wall(const Vec3& ray) {
  const double near = 2 / ray.y();
  return std::abs(near * ray.x()) < 0.3 && std::abs(near * ray.z()) < 0.3 ? near : 4 / ray.y();
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
  const RangeImage wall = scan_of(wall_alone), near = scan_of(thing_and_wall);
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

// A passer-by, 60 cm wide, at y = 2 before the wall; a bench at y = 1 hides what is lower than 10 cm below
// the scanner there.
double passer_by_behind_a_bench(const Vec3& ray) {
  if (ray.z() < -0.05 * ray.y()) return 1 / ray.y();
  return std::abs(ray.x()) < 0.15 * ray.y() ? 2 / ray.y() : 4 / ray.y();
}

TEST(Curtains, what_a_bench_hides_of_a_passer_by_stands_on_the_ground) {
  const RangeImage image = scan_of(passer_by_behind_a_bench);
  std::vector<std::uint32_t> label(image.count(), 0);
  const auto feet = [&](const std::vector<SightScan>& scans) {
    std::vector<Curtain> found;
    for (const Curtain& curtain : stages::hang_curtains(scans))
      if (std::all_of(curtain.begin(), curtain.end(),
                      [&](const Vec3& corner) { return std::abs(corner.y() - 2) < 0.05; }))
        found.push_back(curtain);
    return found;
  };
  const auto alone = feet({{&image, &label, nullptr, {}}});
  ASSERT_GE(alone.size(), 30u);  // as many nodes wide as the passer-by
  for (const Curtain& curtain : alone) {
    for (const Vec3& corner : curtain) EXPECT_LT(std::abs(corner.x()), 0.34);
    // From the last nodes above the bench, 2 cm apart, on.
    EXPECT_NEAR(curtain[0].z(), -0.06, 0.05);
    EXPECT_NEAR(curtain[0].z() - curtain[2].z(), 1.5, 1e-9);
  }
  // None where it goes on beside what hides it, a wall behind a post.
  const RangeImage wall_and_post = scan_of(thing_and_wall);
  for (const Curtain& curtain : stages::hang_curtains({{&wall_and_post, &label, nullptr, {}}}))
    EXPECT_LT(curtain[0].y(), 2.5);
  // None where another scan shows that nothing is there.
  const RangeImage over = scan_of(wall_alone);
  EXPECT_TRUE(feet({{&image, &label, nullptr, {}}, {&over, nullptr, nullptr, {}}}).empty());
  // Of planes and their borders shadow_faces knows more: beside one are two or three nodes, or all.
  std::vector<std::uint32_t> left = label;
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = image.x[i] < 0;
  const auto right = feet({{&image, &left, nullptr, {}}});
  EXPECT_GE(right.size(), alone.size() / 2 - 4);
  for (const Curtain& curtain : right)
    for (const Vec3& corner : curtain) EXPECT_GT(corner.x(), 0);
  std::fill(label.begin(), label.end(), 1);
  EXPECT_TRUE(feet({{&image, &label, nullptr, {}}}).empty());
}

// A post, round and 50 cm thick, at y = 3 before a wall at y = 6.
double post_and_wall(const Vec3& ray) {
  const double level = ray.head<2>().norm(), along = 3 * ray.y() / level;  // of the ray, to beside the axis
  const double beside = 3 * std::abs(ray.x()) / level;
  if (beside < 0.25) return (along - std::sqrt(0.25 * 0.25 - beside * beside)) / level;
  return 6 / ray.y();
}

TEST(Curtains, what_stands_free_and_is_round_is_as_deep_as_it_is_wide) {
  const RangeImage image = scan_of(post_and_wall);
  const std::vector<std::uint32_t> of_none(image.count(), 0);
  std::vector<std::uint8_t> stray(image.count(), 0);
  // Those on the post's back, not those that hang along the rays from its outline.
  const auto on_back = [&](const std::vector<SightScan>& scans) {
    std::vector<Curtain> found;
    for (const Curtain& curtain : stages::hang_curtains(scans))
      if (std::all_of(curtain.begin(), curtain.end(), [](const Vec3& corner) {
            return corner.y() > 3.1 && std::abs(std::hypot(corner.x(), corner.y() - 3) - 0.25) < 0.03;
          }))
        found.push_back(curtain);
    return found;
  };
  const auto backs = on_back({{&image, &of_none, &stray, {}}});
  EXPECT_GT(backs.size(), 80u * 10);  // 80 rows, 16 nodes across
  for (std::size_t i = 0; i < image.count(); i += 7) stray[i] = 1;
  EXPECT_GT(on_back({{&image, &of_none, &stray, {}}}).size(), 80u * 8);
  // What is flat, or part of a plane, has none.
  EXPECT_TRUE(on_back({{&image, nullptr, nullptr, {}}}).empty());
  const RangeImage board = scan_of(
      [](const Vec3& ray) { return std::abs(ray.x()) < 0.25 / 3 * ray.y() ? 2.75 / ray.y() : 6 / ray.y(); });
  for (const Curtain& curtain : stages::hang_curtains({{&board, &of_none, nullptr, {}}}))
    EXPECT_GT((curtain[2] - curtain[1]).norm(), 0.09);  // from outlines on, 10 cm
  // Nor has what is hidden on one side, or where another scan sees that it is empty.
  const RangeImage beside =
      scan_of([](const Vec3& ray) { return ray.x() < -0.03 * ray.y() ? 1 / ray.y() : post_and_wall(ray); });
  EXPECT_TRUE(on_back({{&beside, &of_none, nullptr, {}}}).empty());
  const RangeImage through = scan_of([](const Vec3& ray) { return 6 / ray.y(); });
  const Pose opposite{1, Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(-1.0), Vec3::UnitZ())), {0, 6, 0}};
  EXPECT_TRUE(on_back({{&image, &of_none, nullptr, {}}, {&through, nullptr, nullptr, opposite}}).empty());
}

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

}  // namespace hybrid::testing::curtains_test
