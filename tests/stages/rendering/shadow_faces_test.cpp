#include "stages/rendering/shadow_faces.hpp"

#include "stages/rendering/small_scans.hpp"

namespace hybrid::testing::shadow_faces_test {
namespace {

using namespace stages;

constexpr double kWall_m = 5, kPost_m = 3;  // before the scanner

// A buttress' front, 2 m wide and 3 m high, on a plane across the view.
PolygonModel upright() {
  PolygonModel model;
  model.vertices = {{-1, kWall_m, -1.5}, {1, kWall_m, -1.5}, {1, kWall_m, 1.5}, {-1, kWall_m, 1.5}};
  model.faces = {{"front", {0, 1, 2, 3}, {}}};
  return model;
}

bool is_on(const Vec3& ray, double low, double high) {
  const Vec3 at = kWall_m / ray.y() * ray;
  return std::abs(at.x()) < 1 && at.z() > low && at.z() < high;
}

// With a hole where `hidden` is, on the wall: x from -0.4 to 0.4, and z.
PolygonModel with_hole(double low, double high, double half_width = 0.4) {
  PolygonModel model = upright();
  for (const auto& [x, z] :
       {std::pair{-half_width, low}, {-half_width, high}, {half_width, high}, {half_width, low}})
    model.vertices.emplace_back(x, kWall_m, z);
  if (low > -1.5)
    model.faces[0].holes = {{4, 5, 6, 7}};
  else
    model.faces[0].outer = {0, 4, 5, 6, 7, 1, 2, 3};  // open at the foot
  return model;
}

// A post hides x from -0.4 to 0.4 of the wall between two heights; what is beside the front is far behind it.
double behind_post(const Vec3& ray, double low, double high) {
  const Vec3 at = kWall_m / ray.y() * ray;
  if (std::abs(at.x()) <= 0.4 && at.z() >= low && at.z() <= high) return kPost_m / ray.y();
  return (is_on(ray, -1.5, 1.5) ? kWall_m : 9) / ray.y();
}

// Of a ring, along its front side's normal.
Vec3 area_of(const PolygonModel& model, const std::vector<std::uint32_t>& ring) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k + 2 < ring.size(); ++k)
    sum += 0.5 * (model.vertices[ring[k + 1]] - model.vertices[ring[0]])
                     .cross(Vec3(model.vertices[ring[k + 2]] - model.vertices[ring[0]]));
  return sum;
}

Vec3 area_of(const ShadowFace& face) {
  Vec3 sum = area_of(face.polygon, face.polygon.faces[0].outer);
  for (const auto& hole : face.polygon.faces[0].holes) sum += area_of(face.polygon, hole);
  return sum;
}

double area(const std::vector<ShadowFace>& faces) {
  double sum = 0;
  for (const auto& face : faces) sum += area_of(face).norm();
  return sum;
}

std::vector<ShadowFace> shadows(const std::vector<RangeImage>& images, const PolygonModel& contours,
                                const PolygonModel& model = {}) {
  const std::vector<SightScan> scans = bare_scans(images);
  const ScanSight sight(scans, 0.02);
  return shadow_faces(sight, contours, std::vector<std::size_t>(contours.faces.size(), 0), model);
}

TEST(ShadowFaces, ThePlaneGoesOnBehindWhatHidesIt) {
  const auto image = scan_of([](const Vec3& ray) { return behind_post(ray, -0.5, 0.5); });
  const auto faces = shadows({image}, with_hole(-0.5, 0.5));
  EXPECT_NEAR(area(faces), 0.8 * 1.0, 0.12);
  EXPECT_EQ(faces.size(), 1u);
  for (const auto& face : faces) {
    EXPECT_EQ(face.face, 0u);
    EXPECT_TRUE(can_be_triangulated(face.polygon));
    for (const Vec3& corner : face.polygon.vertices) {
      EXPECT_NEAR(corner.y(), kWall_m, 1e-9);
      EXPECT_LE(std::abs(corner.x()), 0.45);
      EXPECT_LE(std::abs(corner.z()), 0.55);
    }
  }
}

TEST(ShadowFaces, FrontSideIsThePolygons) {
  const auto image = scan_of([](const Vec3& ray) { return behind_post(ray, -0.5, 0.5); });
  for (const auto& face : shadows({image}, with_hole(-0.5, 0.5)))
    EXPECT_LT(area_of(face).normalized().y(), -0.99);
}

TEST(ShadowFaces, AnUprightOneGoesDownToItsFoot) {
  const auto image = scan_of([](const Vec3& ray) { return behind_post(ray, -1.5, 0.5); });
  EXPECT_NEAR(area(shadows({image}, with_hole(-1.5, 0.5))), 0.8 * 2.0, 0.15);
}

// The buttress' flank, of which a post hides the lower half, ends above the front's foot; there it goes on,
// also where the front's samples stop 15 cm beside it, and not at 30.
TEST(ShadowFaces, AnUprightOneGoesDownToTheFootOfTheOneItMeets) {
  constexpr double kFlank_m = 0.5, kDeep_m = 6;
  const auto image = scan_of([](const Vec3& ray) {
    const Vec3 flank = kFlank_m / ray.x() * ray;
    const bool on_flank = ray.x() > 0 && flank.y() > kWall_m && flank.y() < kDeep_m;
    if (on_flank && flank.z() < 0) return kPost_m / ray.y();
    return on_flank ? kFlank_m / ray.x() : kDeep_m / ray.y();
  });
  PolygonModel model;
  model.vertices = {{kFlank_m, kDeep_m, 0}, {kFlank_m, kWall_m, 0},    {kFlank_m, kWall_m, 1},
                    {kFlank_m, kDeep_m, 1}, {kFlank_m, kWall_m, -1.2}, {1.5, kWall_m, -1.2},
                    {1.5, kWall_m, 1},      {kFlank_m, kWall_m, 1}};
  model.faces = {{"flank", {0, 1, 2, 3}, {}}};
  EXPECT_TRUE(shadows({image}, model).empty());
  model.faces.push_back({"front", {4, 5, 6, 7}, {}});
  for (const double gap_m : {0.0, 0.15, 0.3}) {
    for (const std::size_t corner : {4, 7}) model.vertices[corner].x() = kFlank_m + gap_m;
    double of_flank = 0;
    for (const auto& face : shadows({image}, model))
      if (face.face == 0) of_flank += area_of(face).norm();
    EXPECT_NEAR(of_flank, gap_m < 0.2 ? 1.2 * (kDeep_m - kWall_m) : 0, 0.2) << gap_m;
  }
}

// A bench hides the lower half of the front but for a strip on the right, of which the contour is another
// polygon.
TEST(ShadowFaces, PartsOfOneSurfaceStandOnTheSameGround) {
  const auto image = scan_of([](const Vec3& ray) {
    const Vec3 at = kWall_m / ray.y() * ray;
    if (at.x() > -1 && at.x() < 0.45 && at.z() < 0) return kPost_m / ray.y();
    return (is_on(ray, -1.5, 1.5) ? kWall_m : 9) / ray.y();
  });
  PolygonModel model;
  model.vertices = {{-1, kWall_m, 0},     {0.4, kWall_m, 0},  {0.4, kWall_m, 1.5}, {-1, kWall_m, 1.5},
                    {0.5, kWall_m, -1.5}, {1, kWall_m, -1.5}, {1, kWall_m, 1.5},   {0.5, kWall_m, 1.5}};
  model.faces = {{"front", {0, 1, 2, 3}, {}}};
  EXPECT_TRUE(shadows({image}, model).empty());
  model.faces.push_back({"front", {4, 5, 6, 7}, {}});
  EXPECT_NEAR(area(shadows({image}, model)), 1.4 * 1.5, 0.2);
  for (const std::size_t corner : {4, 5, 6, 7}) model.vertices[corner].y() += 0.05;  // a surface of its own
  EXPECT_TRUE(shadows({image}, model).empty());
}

TEST(ShadowFaces, WhatAnyScanLooksThroughStaysOpen) {
  const auto image = scan_of([](const Vec3& ray) { return behind_post(ray, -0.5, 0.5); });
  const auto through = scan_of([](const Vec3& ray) { return 9 / ray.y(); });
  EXPECT_TRUE(shadows({image, through}, with_hole(-0.5, 0.5)).empty());
}

// A bench before an opening hides its lower part from side to side; above it the scan looks through.
TEST(ShadowFaces, AnOpeningHalfHiddenStaysOpen) {
  const auto image = scan_of([](const Vec3& ray) {
    const Vec3 at = kWall_m / ray.y() * ray;
    if (std::abs(at.x()) <= 0.4 && at.z() > -0.3 && at.z() <= 0.5) return 9 / ray.y();
    return behind_post(ray, -0.5, -0.3);
  });
  EXPECT_TRUE(shadows({image}, with_hole(-0.5, 0.5)).empty());
}

// No return in a rectangle of it.
RangeImage nothing_measured(double half_width, double half_height) {
  RangeImage image = scan_of([](const Vec3& ray) { return behind_post(ray, 2, 2); });
  for (std::size_t i = 0; i < image.count(); ++i)
    if (std::abs(image.point(i).x()) <= half_width && std::abs(image.point(i).z()) <= half_height)
      image.mask[i] = kEmpty;
  return image;
}

TEST(ShadowFaces, WhatLacksAFewSamplesIsNoOpening) {
  const auto few = nothing_measured(0.06, 0.06);
  EXPECT_NEAR(area(shadows({few}, with_hole(-0.06, 0.06, 0.06))), 0.16 * 0.16, 0.012);
  const auto window = nothing_measured(0.4, 0.4);
  EXPECT_TRUE(shadows({window}, with_hole(-0.4, 0.4)).empty());
  const auto through = scan_of([](const Vec3& ray) { return 9 / ray.y(); });
  EXPECT_TRUE(shadows({few, through}, with_hole(-0.06, 0.06, 0.06)).empty());
}

TEST(ShadowFaces, ADarkBandIsNoOpening) {
  const PolygonModel contours = with_hole(-0.05, 0.05, 0.8);
  const auto band = nothing_measured(0.8, 0.05);
  EXPECT_NEAR(area(shadows({band}, contours)), 1.64 * 0.14, 0.02);
  // Beams of a scanner 1.8 m before it that return from far behind: single ones did not pass, some side by
  // side did.
  const auto beside = [&](const std::vector<double>& passing) {
    std::vector<RangeImage> images = {band, scan_of([](const Vec3& ray) { return 9 / ray.y(); })};
    RangeImage& near = images[1];
    std::fill(near.mask.begin(), near.mask.end(), kEmpty);
    for (const double x : passing) {
      const auto node = NodeLookup(near).towards({x, 1.8, 0});
      near.mask[near.index(node.row, node.col)] = kMeasured;
    }
    auto scans = bare_scans(images);
    scans[1].world_from_scan.translation = {0, kWall_m - 1.8, 0};
    return shadow_faces(ScanSight(scans, 0.02), contours, {0}, {});
  };
  EXPECT_NEAR(area(beside({-0.3, 0.3})), 1.64 * 0.14, 0.02);
  EXPECT_TRUE(beside({0.3, 0.318, 0.336, 0.354}).empty());
}

// Gaps before the sky, from which nothing returns, as wide as the dark band and 1.6 m high; bars between
// them.
TEST(ShadowFaces, BetweenBarsItStaysOpen) {
  constexpr double kGap_m = 0.1, kHigh_m = 0.8;
  const auto gaps = [&](const std::vector<double>& middles) {
    PolygonModel contours = upright();
    RangeImage image = nothing_measured(0, 0);
    for (const double middle : middles) {
      const auto first = static_cast<std::uint32_t>(contours.vertices.size());
      const double left = middle - kGap_m / 2, right = middle + kGap_m / 2;
      for (const auto& [x, z] :
           {std::pair{left, -kHigh_m}, {left, kHigh_m}, {right, kHigh_m}, {right, -kHigh_m}})
        contours.vertices.emplace_back(x, kWall_m, z);
      contours.faces[0].holes.push_back({first, first + 1, first + 2, first + 3});
      for (std::size_t i = 0; i < image.count(); ++i)
        if (std::abs(image.point(i).x() - middle) <= kGap_m / 2 && std::abs(image.point(i).z()) <= kHigh_m)
          image.mask[i] = kEmpty;
    }
    return area(shadows({image}, contours));
  };
  const double one = (kGap_m + 0.02) * 2 * (kHigh_m + 0.01);  // of cells: four inside, with the overlap six
  EXPECT_NEAR(gaps({0}), one, 0.02);
  EXPECT_NEAR(gaps({-0.4, 0.4}), 2 * one, 0.04);  // a door's bands
  EXPECT_EQ(gaps({-0.16, 0, 0.16}), 0);
  EXPECT_EQ(gaps({-0.07, 0.07}), 0);
}

// A wall 3 m before the scanner, of which the left side goes back to the plane, hides the plane from where
// its edge is in the way to where they meet.
TEST(ShadowFaces, BehindABodysEdgeItGoesOnToTheCorner) {
  constexpr double kLeft_m = -0.6, kSeen_m = kLeft_m / kPost_m * kWall_m;
  const auto image = scan_of([](const Vec3& ray) {
    const double before = kPost_m / ray.y() * ray.x(), on = kWall_m / ray.y() * ray.x();
    if (before > kLeft_m && before < 1) return kPost_m / ray.y();
    return (on > -2 && std::abs(kWall_m / ray.y() * ray.z()) < 1.5 ? kWall_m : 9) / ray.y();
  });
  const auto buttress = [&](double left) {
    PolygonModel model = upright();
    for (const std::size_t corner : {0, 3}) model.vertices[corner].x() = left;
    for (const std::size_t corner : {1, 2}) model.vertices[corner].x() = kSeen_m;
    return model;
  };
  const auto side = [&](double from, double to) {
    PolygonModel model;
    model.vertices = {{kLeft_m, to, -2}, {kLeft_m, from, -2}, {kLeft_m, from, 2}, {kLeft_m, to, 2}};
    model.faces = {{"left", {0, 1, 2, 3}, {}}};
    return model;
  };
  const auto faces = shadows({image}, buttress(-2), side(kPost_m, 8));
  ASSERT_EQ(faces.size(), 1u);
  EXPECT_NEAR(area(faces), (kLeft_m - kSeen_m) * 3, 0.12);
  for (const Vec3& corner : faces[0].polygon.vertices) {
    EXPECT_NEAR(corner.y(), kWall_m, 1e-9);
    EXPECT_GT(corner.x(), kSeen_m - 0.05);
    EXPECT_LT(corner.x(), kLeft_m + 0.025);
  }
  const auto is_open = [&](const PolygonModel& contours, const PolygonModel& model) {
    return shadows({image}, contours, model).empty();
  };
  EXPECT_TRUE(is_open(buttress(-2), {}));                           // no corner
  EXPECT_TRUE(is_open(buttress(-2), side(8, kPost_m)));             // its front is the other side
  EXPECT_TRUE(is_open(buttress(-2), side(4.6, 8)));                 // another body hides it
  EXPECT_TRUE(is_open(buttress(kSeen_m - 0.3), side(kPost_m, 8)));  // less is seen than hidden
  PolygonModel both = buttress(-2);
  const PolygonModel left = side(kPost_m, 8);
  for (const Vec3& vertex : left.vertices) both.vertices.push_back(vertex);
  both.faces.push_back({"left", {4, 5, 6, 7}, {}});  // another scan has the wall's side
  double of_front = 0;
  for (const auto& face : shadows({image}, both))
    if (face.face == 0) of_front += area_of(face).norm();
  EXPECT_NEAR(of_front, (kLeft_m - kSeen_m) * 3, 0.12);
}

TEST(ShadowFaces, NothingBesideItGoesOn) {
  const auto image = scan_of([](const Vec3& ray) {
    const Vec3 at = kWall_m / ray.y() * ray;
    return std::abs(at.x()) > 1 ? kPost_m / ray.y() : behind_post(ray, 2, 2);
  });
  EXPECT_TRUE(shadows({image}, upright()).empty());
}

TEST(ShadowFaces, InTheOrderOfFaces) {
  const auto image = scan_of([](const Vec3& ray) { return behind_post(ray, -1.5, 0.5); });
  PolygonModel two = with_hole(-1.5, 0.5);
  two.faces.push_back(two.faces[0]);
  const auto faces = shadows({image}, two);
  ASSERT_FALSE(faces.empty());
  ASSERT_EQ(faces.size() % 2, 0u);
  for (std::size_t k = 0; k < faces.size() / 2; ++k) {
    EXPECT_EQ(faces[k].polygon.vertices, faces[faces.size() / 2 + k].polygon.vertices);
    EXPECT_EQ(faces[faces.size() / 2 + k].face, 1u);
  }
}

}  // namespace
}  // namespace hybrid::testing::shadow_faces_test
