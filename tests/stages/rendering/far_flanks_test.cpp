#include "stages/rendering/far_flanks.hpp"

#include <algorithm>

#include "stages/rendering/small_scans.hpp"

namespace hybrid::testing::far_flanks_test {
namespace {

using namespace stages;

constexpr double kFront_m = 5, kWall_m = 6;    // before the scanner
constexpr double kNear_m = 0.5, kFar_m = 1.5;  // to its right: the buttress between them
constexpr double kHigh_m = 1;

// A buttress before a wall; the scanner sees its front and its left flank.
double buttress(const Vec3& ray) {
  const Vec3 front = kFront_m / ray.y() * ray;
  if (front.x() >= kNear_m && front.x() <= kFar_m) return kFront_m / ray.y();
  const Vec3 flank = kNear_m / ray.x() * ray;
  if (ray.x() > 0 && flank.y() >= kFront_m && flank.y() <= kWall_m) return kNear_m / ray.x();
  return kWall_m / ray.y();
}

// A post before the far border hides what is to the right of it, up to a height.
double with_post(const Vec3& ray, double low) {
  const Vec3 at = kFront_m / ray.y() * ray;
  const bool post = at.x() > kFar_m - 0.05 && at.x() < kFar_m + 0.4 && at.z() > low;
  return post ? 3 / ray.y() : buttress(ray);
}

// The front as far as `right`, and the flank, `gap` behind it.
PolygonModel contours(double right, double gap = 0) {
  PolygonModel model;
  const double from = kFront_m + gap;
  model.vertices = {{kNear_m, kFront_m, -kHigh_m}, {right, kFront_m, -kHigh_m},  {right, kFront_m, kHigh_m},
                    {kNear_m, kFront_m, kHigh_m},  {kNear_m, kWall_m, -kHigh_m}, {kNear_m, from, -kHigh_m},
                    {kNear_m, from, kHigh_m},      {kNear_m, kWall_m, kHigh_m}};
  model.faces = {{"front", {0, 1, 2, 3}, {}}, {"flank", {4, 5, 6, 7}, {}}};
  return model;
}

std::vector<FarFlank> flanks(const std::vector<RangeImage>& images, const PolygonModel& model) {
  const std::vector<SightScan> scans = bare_scans(images);
  const ScanSight sight(scans, 0.02);
  // Front and flank were seen; a third face goes on with the flank where it has its name.
  std::vector<std::size_t> part_of;
  for (std::size_t face = 0; face < model.faces.size(); ++face)
    part_of.push_back(face < 2 ? face : model.faces[face].name == "flank" ? 1 : kPartOfNone);
  return far_flanks(sight, model, part_of);
}

void expect_whole(const std::vector<FarFlank>& found) {
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].face, 0u);
  Vec3 low = found[0].corners[0], high = low;
  for (const Vec3& corner : found[0].corners) {
    EXPECT_NEAR(corner.x(), kFar_m, 0.05);
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  EXPECT_NEAR(low.y(), kFront_m, 1e-9);
  EXPECT_NEAR(high.y(), kWall_m, 1e-9);
  EXPECT_NEAR(low.z(), -kHigh_m, 1e-9);
  EXPECT_NEAR(high.z(), kHigh_m, 1e-9);
  const auto& c = found[0].corners;
  EXPECT_GT((c[1] - c[0]).cross(Vec3(c[3] - c[0])).x(), 0);  // front side outwards
}

}  // namespace

TEST(FarFlanks, WhatJutsOutHasTwo) {
  expect_whole(flanks({scan_of(buttress)}, contours(kFar_m)));
  // Its border is a little farther than where its samples end.
  const auto found = flanks({scan_of(buttress)}, contours(kFar_m - 0.06));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found[0].corners[0].x(), kFar_m - 0.06);
  EXPECT_LE(found[0].corners[0].x(), kFar_m + 0.05);
}

TEST(FarFlanks, WhatHidesAPartOfTheBorderDoesNotMatter) {
  const auto post = [](double low) {
    return scan_of([low](const Vec3& ray) { return with_post(ray, low); });
  };
  expect_whole(flanks({post(0.3)}, contours(kFar_m)));
  EXPECT_TRUE(flanks({post(-2)}, contours(kFar_m)).empty());
}

TEST(FarFlanks, WhatGoesOnWithASeenOneCounts) {
  const auto image = scan_of(buttress);
  PolygonModel half = contours(kFar_m);
  half.vertices[4].z() = half.vertices[5].z() = 0;
  const auto found = flanks({image}, half);
  ASSERT_EQ(found.size(), 1u);
  for (const Vec3& corner : found[0].corners) EXPECT_GE(corner.z(), -1e-9);
  for (const double z : {-kHigh_m, 0.02})
    for (const double y : {kWall_m, kFront_m}) half.vertices.emplace_back(kNear_m, y, z);
  half.faces.push_back({"flank", {8, 9, 11, 10}, {}});
  expect_whole(flanks({image}, half));
}

// At a grazing angle a flank's samples begin some way behind the front.
TEST(FarFlanks, ASeenOneMayBeginALittleBehindTheFront) {
  expect_whole(flanks({scan_of(buttress)}, contours(kFar_m, 0.06)));
}

TEST(FarFlanks, NoneWithoutASeenOneNorWhereItIsSeenToBeEmpty) {
  PolygonModel front = contours(kFar_m);
  front.faces.pop_back();
  const auto image = scan_of(buttress);
  EXPECT_TRUE(flanks({image}, front).empty());
  EXPECT_TRUE(flanks({image}, {}).empty());
  EXPECT_TRUE(flanks({image}, contours(kFar_m, 0.2)).empty());   // not the front's
  EXPECT_TRUE(flanks({image}, contours(kFar_m - 0.4)).empty());  // the front goes on
  const auto through = scan_of([](const Vec3& ray) { return kWall_m / ray.y(); });
  EXPECT_TRUE(flanks({image, through}, contours(kFar_m)).empty());
  // Nor where there is a face.
  PolygonModel closed = contours(kFar_m);
  for (const double y : {kWall_m, kFront_m})
    for (const double z : {-kHigh_m, kHigh_m}) closed.vertices.emplace_back(kFar_m + 0.02, y, z);
  closed.faces.push_back({"there", {8, 9, 11, 10}, {}});
  ASSERT_EQ(flanks({image}, contours(kFar_m)).size(), 1u);
  EXPECT_TRUE(flanks({image}, closed).empty());
  std::swap(closed.faces.back().outer[0], closed.faces.back().outer[2]);  // its back
  EXPECT_EQ(flanks({image}, closed).size(), 1u);
  // From behind the front it is no flank.
  PolygonModel turned = contours(kFar_m);
  std::reverse(turned.faces[0].outer.begin(), turned.faces[0].outer.end());
  EXPECT_TRUE(flanks({image}, turned).empty());
}

}  // namespace hybrid::testing::far_flanks_test
