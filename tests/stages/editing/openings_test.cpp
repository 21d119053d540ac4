#include "stages/editing/openings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "stages/editing/displacement.hpp"

namespace hybrid::stages::openings_test {
namespace {

constexpr double kStep = 0.002;  // rad: 1 cm on a wall 5 m away

// A scan from (2, -5, 1.5) of a wall y = 0 with whatever `surface` puts where (x, z) of the wall is.
struct Scene {
  RangeImage image;
  PlaneSegmentation segmentation;
  Pose pose{1, Eigen::Quaterniond::Identity(), Vec3(2, -5, 1.5)};
};

// How far behind the wall (along y) a ray through its point (x, z) ends; infinite: no return.
using Depth = std::function<double(double x, double z)>;
// The supercluster that such a ray's sample belongs to: 1 the wall, 2 to 4 reveals of the window's left, its
// sill and its lintel, 5 a splayed left one.
using Label = std::function<std::uint32_t(double x, double z, double behind)>;

std::uint32_t parallel_where_near(double, double, double behind) {
  return std::abs(behind) < 0.45 ? 1 : 0;  // walls, panes
}

Scene scan(const Depth& depth, const Label& label = parallel_where_near) {
  Scene scene;
  const int rows = 560, cols = 800;
  scene.image = make_range_image(rows, cols);
  for (int row = 0; row < rows; ++row)
    scene.image.elevation_rad[static_cast<std::size_t>(row)] = (rows / 2 - row) * kStep;
  for (int col = 0; col < cols; ++col)
    scene.image.azimuth_rad[static_cast<std::size_t>(col)] = M_PI / 2 + (col - cols / 2) * kStep;
  scene.segmentation.sample_label.assign(scene.image.count(), 0);
  Supercluster wall;
  wall.id = 1;
  wall.plane = {-Vec3::UnitY(), -5};
  scene.segmentation.superclusters.assign(5, wall);
  auto& planes = scene.segmentation.superclusters;
  planes[1].plane = {Vec3::UnitX(), -1};
  planes[2].plane = {Vec3::UnitZ(), -0.7};
  planes[3].plane = {-Vec3::UnitZ(), -0.7};
  planes[4].plane = {Vec3(1, -0.5, 0).normalized(), -3};
  unsigned noise = 1;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const double el = scene.image.elevation_rad[static_cast<std::size_t>(row)];
      const double az = scene.image.azimuth_rad[static_cast<std::size_t>(col)];
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const Vec3 at = scene.pose.translation + 5 / ray.y() * ray;
      const double behind = depth(at.x(), at.z());
      const std::size_t i = scene.image.index(row, col);
      if (!std::isfinite(behind)) continue;
      noise = noise * 1664525u + 1013904223u;
      const double range = (5 + behind) / ray.y() + 0.004 * ((noise >> 8) / 16777216.0 - 0.5);
      scene.image.x[i] = static_cast<float>(range * ray.x());
      scene.image.y[i] = static_cast<float>(range * ray.y());
      scene.image.z[i] = static_cast<float>(range * ray.z());
      scene.image.range_m[i] = static_cast<float>(range);
      scene.image.mask[i] = kMeasured;
      scene.segmentation.sample_label[i] = label(at.x(), at.z(), behind);
    }
  return scene;
}

PolygonModel wall_model() {
  PolygonModel model;
  model.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 0, 3}, {0, 0, 3}};
  model.faces = {{"wall", {0, 1, 2, 3}, {}}};
  return model;
}

bool in_window(double x, double z) {
  return x > 1 && x < 2 && z > 0.8 && z < 2.2;
}

Openings find(const Scene& scene, const std::string& mode = "cut") {
  OpeningOptions options;
  options.openings = mode;
  return find_openings(wall_model(), {{&scene.image, &scene.segmentation, nullptr, scene.pose, 0.001, {}}},
                       options);
}

// Of places every centimetre along a true border, how far the farthest lies from the ring.
double border_off_m(const Ring2& truth, const Ring2& ring) {
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec2 arm = truth[(i + 1) % truth.size()] - truth[i];
    for (double t = 0; t < 1; t += 0.01 / arm.norm())
      worst = std::max(worst, distance_to_border(ring, truth[i] + t * arm));
  }
  return worst;
}

// A pointed window: arcs of 1 m about the opposite springing points.
Ring2 pointed_window() {
  Ring2 ring = {{1, 0.6}, {2, 0.6}};
  for (int k = 0; k <= 30; ++k) ring.push_back({1 + std::cos(k * M_PI / 90), 1.6 + std::sin(k * M_PI / 90)});
  for (int k = 29; k >= 0; --k) ring.push_back({2 - std::cos(k * M_PI / 90), 1.6 + std::sin(k * M_PI / 90)});
  return ring;
}

double farthest_corner_mm(const Ring2& ring) {
  double worst = 0;
  for (const Vec2& corner : {Vec2(1, 0.8), Vec2(2, 0.8), Vec2(2, 2.2), Vec2(1, 2.2)}) {
    double nearest = 1e9;
    for (const Vec2& p : ring) nearest = std::min(nearest, (p - corner).norm());
    worst = std::max(worst, nearest);
  }
  return 1000 * worst;
}

}  // namespace

TEST(Openings, a_window_is_found_with_its_corners_and_cut) {
  const Openings found = find(scan([](double x, double z) { return in_window(x, z) ? 3.0 : 0.0; }));
  ASSERT_EQ(found.openings.size(), 1u);
  const Opening& window = found.openings[0];
  EXPECT_TRUE(window.cut) << window.why_not;
  EXPECT_EQ(window.ring.size(), 4u);
  EXPECT_LT(farthest_corner_mm(window.ring), 10);  // the samples' spacing
  EXPECT_NEAR(window.area_m2, 1.4, 0.02);
  EXPECT_NEAR(static_cast<double>(window.rays), 14000, 3000);
  EXPECT_EQ(window.kind, "open");
  EXPECT_GT(window.confidence, 0.9);
  EXPECT_EQ(found.faces[0].status, "as modelled");
}

TEST(Openings, panes_that_let_some_rays_through_are_glass_and_a_niche_is_a_recess) {
  int turn = 0;
  const auto glass = find(scan([&](double x, double z) {
    if (!in_window(x, z)) return 0.0;
    ++turn;
    return turn % 3 == 0 ? 0.3 : turn % 3 == 1 ? 4.0 : INFINITY;  // pane, room behind it, lost
  }));
  ASSERT_EQ(glass.openings.size(), 1u);
  EXPECT_EQ(glass.openings[0].kind, "glass");
  EXPECT_LT(farthest_corner_mm(glass.openings[0].ring), 25);
  const auto niche = find(scan([](double x, double z) { return in_window(x, z) ? 0.3 : 0.0; }));
  ASSERT_EQ(niche.openings.size(), 1u);
  EXPECT_EQ(niche.openings[0].kind, "recess");
}

// The bound of hybrid-score: 3 cm, or two spacings.
TEST(Openings,
     borders_of_arches_and_circles_are_within_two_spacings_though_glass_swallows_rays_and_things_hide_them) {
  const double bound = 2 * 5 * kStep;
  const Ring2 pointed = pointed_window();
  int turn = 0;
  const auto arch = find(scan([&](double x, double z) {
    if (x > 1.8 && x < 2.3 && z > 0.9 && z < 1.4) return -0.5;  // something before the right jamb
    if (!inside(pointed, {x, z})) return 0.0;
    return ++turn % 5 == 0 ? 3.0 : static_cast<double>(INFINITY);
  }));
  ASSERT_EQ(arch.openings.size(), 1u);
  EXPECT_LT(border_off_m(pointed, arch.openings[0].ring), bound);
  EXPECT_LT(border_off_m(arch.openings[0].ring, pointed), bound);
  Ring2 round;
  for (int k = 0; k < 120; ++k)
    round.push_back(Vec2(2, 1.5) + 0.8 * Vec2(std::cos(k * M_PI / 60), std::sin(k * M_PI / 60)));
  const auto rose = find(scan([&](double x, double z) {
    if (x > 1.4 && x < 1.8 && z < 0.95) return -0.5;
    if (!inside(round, {x, z})) return 0.0;
    return ++turn % 5 == 0 ? 3.0 : static_cast<double>(INFINITY);
  }));
  ASSERT_EQ(rose.openings.size(), 1u);
  EXPECT_LT(border_off_m(round, rose.openings[0].ring), bound);
  EXPECT_LT(border_off_m(rose.openings[0].ring, round), bound);
}

TEST(Openings, what_no_builder_draws_keeps_its_own_border) {
  const Ring2 step = {{1, 0.5}, {3, 0.5}, {3, 1.2}, {2, 1.2}, {2, 2.2}, {1, 2.2}};
  const auto found = find(scan([&](double x, double z) { return inside(step, {x, z}) ? 3.0 : 0.0; }));
  ASSERT_EQ(found.openings.size(), 1u);
  EXPECT_LT(border_off_m(step, found.openings[0].ring), 2 * 5 * kStep);
}

TEST(Openings, an_open_leaf_does_not_end_the_opening_that_it_stands_in) {
  const auto leaf = [](double x, double z) { return in_window(x, z) && x > 1.15 && x < 1.2; };
  const auto found = find(scan(
      [&](double x, double z) {
        if (leaf(x, z)) return 5 * (x - 1.175);
        return in_window(x, z) ? 3.0 : 0.0;
      },
      [&](double x, double z, double behind) {
        return leaf(x, z) ? 2u : parallel_where_near(x, z, behind);
      }));
  ASSERT_EQ(found.openings.size(), 1u);
  EXPECT_LT(farthest_corner_mm(found.openings[0].ring), 10);
  EXPECT_LT(found.openings[0].against, 20);  // where it crosses the face it does not close the opening
}

// A wall of 50 cm whose other side nobody scanned.
TEST(Openings, an_opening_is_carried_through_a_wall_with_straight_reveals_only) {
  PolygonModel model = wall_model();
  model.vertices.insert(model.vertices.end(), {{4, 0.5, 0}, {0, 0.5, 0}, {0, 0.5, 3}, {4, 0.5, 3}});
  model.faces.push_back({"outside", {4, 5, 6, 7}, {}});
  const auto left = [](double x) { return 5 / (2 - x) - 5; };
  const auto level = [](double z) { return 3.5 / std::abs(1.5 - z) - 5; };
  const auto depth = [&](double x, double z) {
    return in_window(x, z) ? std::min({left(x), level(z), 3.0}) : 0.0;
  };
  for (const bool straight : {true, false}) {
    const Scene scene = scan(depth, [&](double x, double z, double behind) -> std::uint32_t {
      if (!in_window(x, z)) return 1;
      if (behind >= 0.5) return 0;
      if (!straight) return 5;
      return left(x) < level(z) ? 2 : z < 1.5 ? 3 : 4;
    });
    OpeningOptions options;
    options.openings = "cut";
    const auto found =
        find_openings(model, {{&scene.image, &scene.segmentation, nullptr, scene.pose, 0.001, {}}}, options);
    ASSERT_EQ(found.openings.size(), straight ? 2u : 1u);
    if (!straight) continue;
    const Opening& outside = found.openings[1];
    EXPECT_EQ(outside.carried_from, 0u);
    EXPECT_TRUE(outside.cut) << outside.why_not;
    EXPECT_LT(border_off_m({{2, 0.8}, {3, 0.8}, {3, 2.2}, {2, 2.2}}, outside.ring),
              0.02);  // seen from behind
  }
}

// Of the other side of that wall a second scan sees the window between two columns, no jamb of it.
TEST(Openings, an_opening_is_carried_to_where_little_of_it_was_seen_but_not_a_niche) {
  PolygonModel model = wall_model();
  model.vertices.insert(model.vertices.end(), {{4, 0.5, 0}, {0, 0.5, 0}, {0, 0.5, 3}, {4, 0.5, 3}});
  model.faces.push_back({"outside", {4, 5, 6, 7}, {}});
  const auto left = [](double x) { return 5 / (2 - x) - 5; };
  for (const bool open : {true, false}) {  // a niche of 40 cm
    const Scene inside_scan =
        scan([&](double x, double z) { return in_window(x, z) ? std::min(left(x), open ? 3.0 : 0.4) : 0.0; },
             [&](double x, double z, double behind) -> std::uint32_t {
               return !in_window(x, z) ? 1 : behind < 0.39 ? 2 : 0;
             });
    Scene outside_scan = scan([&](double x, double z) {
      const bool column = x > 1.8 && x < 3.2 && !(x > 2.4 && x < 2.6);
      return column ? -2.0 : open && in_window(4 - x, z) ? 3.0 : 0.0;
    });
    outside_scan.pose = {1, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Vec3::UnitZ())), {2, 5.5, 1.5}};
    OpeningOptions options;
    options.openings = "cut";
    std::vector<OpeningScan> scans;
    for (const Scene* scene : {&inside_scan, static_cast<const Scene*>(&outside_scan)})
      scans.push_back({&scene->image, &scene->segmentation, nullptr, scene->pose, 0.001, {}});
    const auto found = find_openings(model, scans, options);
    EXPECT_TRUE(found.faces[1].seen);
    ASSERT_EQ(found.openings.size(), open ? 2u : 1u);
    if (!open) continue;
    const Opening& outside = found.openings[1];
    EXPECT_EQ(outside.carried_from, 0u);
    EXPECT_TRUE(outside.cut) << outside.why_not;
    EXPECT_LT(border_off_m({{2, 0.8}, {3, 0.8}, {3, 2.2}, {2, 2.2}}, outside.ring), 0.02);
  }
}

// Two windows of 80 by 80 cm; a column 2 m before the wall hides what lies between two places of it.
TEST(Openings, a_window_hidden_in_part_has_the_border_of_a_whole_one_of_its_design) {
  const auto in_either = [](double x, double z) {
    return z > 0.8 && z < 1.6 && ((x > 0.4 && x < 1.2) || (x > 2.4 && x < 3.2));
  };
  const auto behind_column = [&](double from, double to) {
    return [=](double x, double z) { return x > from && x < to ? -2.0 : in_either(x, z) ? 3.0 : 0.0; };
  };
  const Ring2 second = {{2.4, 0.8}, {3.2, 0.8}, {3.2, 1.6}, {2.4, 1.6}};
  const Openings found = find(scan(behind_column(2.7, 3.4)));
  ASSERT_EQ(found.openings.size(), 2u);
  int completed = 0;
  for (const Opening& opening : found.openings) {
    EXPECT_TRUE(opening.cut) << opening.why_not;
    if (!opening.completed_from) continue;
    ++completed;
    EXPECT_EQ(opening.completed_from, 0u);
    EXPECT_LT(border_off_m(second, opening.ring), 0.02);
    EXPECT_NEAR(opening.area_m2, 0.8 * 0.8, 0.02);
    EXPECT_LT(opening.border_seen, 0.7);  // jamb, and the parts of sill and lintel beside it
  }
  EXPECT_EQ(completed, 1);
  // Without the other one it ends where the column begins.
  const Openings alone =
      find(scan([&](double x, double z) { return x < 2 ? 0.0 : behind_column(2.7, 3.4)(x, z); }));
  ASSERT_EQ(alone.openings.size(), 1u);
  EXPECT_FALSE(alone.openings[0].completed_from);
  EXPECT_GT(border_off_m(second, alone.openings[0].ring), 0.3);
  // One opening also where what is seen of it are two pieces.
  const Openings pieces = find(scan([&](double x, double z) {
    return x > 2.7 && x < 2.9 ? -2.0 : in_either(x, z) ? 3.0 : 0.0;
  }));
  ASSERT_EQ(pieces.openings.size(), 2u);
  EXPECT_LT(border_off_m(second, pieces.openings[0].ring[0].x() > 2 ? pieces.openings[0].ring
                                                                    : pieces.openings[1].ring),
            0.02);
  // Nor with it where the wall was seen beside the column, or where both jambs are hidden.
  const Openings narrower = find(scan([&](double x, double z) {
    return x > 2.7 && x < 2.9 ? -2.0 : in_either(x, z) && x < 2.9 ? 3.0 : 0.0;
  }));
  const Openings unheld = find(scan([&](double x, double z) {
    return (x > 2.1 && x < 2.5) || (x > 3.1 && x < 3.5) ? -2.0 : in_either(x, z) ? 3.0 : 0.0;
  }));
  for (const Openings& other : {narrower, unheld}) {
    EXPECT_EQ(other.openings.size(), 2u);
    for (const Opening& opening : other.openings) EXPECT_FALSE(opening.completed_from);
  }
}

// Of the second window a column leaves 7 cm.
TEST(Openings, a_window_all_but_hidden_is_one_of_its_row_or_none) {
  const Depth row = [](double x, double z) {
    const bool open = z > 0.8 && z < 1.6 && ((x > 0.4 && x < 1.2) || (x > 2 && x < 2.8));
    return x > 2.07 && x < 3 ? -2.0 : open ? 3.0 : 0.0;
  };
  const Openings found = find(scan(row));
  ASSERT_EQ(found.openings.size(), 2u);
  const Opening& second = found.openings[found.openings[0].completed_from ? 0 : 1];
  EXPECT_TRUE(second.cut) << second.why_not;
  EXPECT_EQ(second.completed_from, 0u);
  EXPECT_LT(border_off_m({{2, 0.8}, {2.8, 0.8}, {2.8, 1.6}, {2, 1.6}}, second.ring), 0.02);
  EXPECT_LT(second.border_seen, 0.4);
  // Not with no other one, with one at another level, or where another of the row would fit as well.
  const Depth alone = [&](double x, double z) { return x < 2 ? 0.0 : row(x, z); };
  const Depth higher = [&](double x, double z) { return row(x, x < 2 ? z - 0.3 : z); };
  const Depth either = [&](double x, double z) {
    return x > 3.3 && x < 3.7 && z > 0.8 && z < 1.6 ? 3.0 : row(x, z);
  };
  for (const auto& [depth, whole] : {std::pair{alone, 0u}, {higher, 1u}, {either, 2u}}) {
    const Openings others = find(scan(depth));
    EXPECT_EQ(others.openings.size(), whole);
    for (const Opening& opening : others.openings) EXPECT_FALSE(opening.completed_from);
  }
}

TEST(Openings, nothing_is_found_in_a_closed_wall) {
  EXPECT_TRUE(find(scan([](double, double) { return 0.0; })).openings.empty());
  // Dents of less than the depth, clutter before it, lost returns, single rays that went astray.
  int turn = 0;
  EXPECT_TRUE(find(scan([&](double x, double z) {
                if (in_window(x, z)) return 0.08;
                if (x > 3) return -0.5;
                if (z > 2.5) return static_cast<double>(INFINITY);
                return ++turn % 50 == 0 ? 2.0 : 0.0;
              })).openings.empty());
}

TEST(Openings, a_wall_modelled_15_cm_off_is_reported_and_never_cut) {
  for (const double off : {0.15, -0.15}) {
    const auto plain = find(scan([&](double, double) { return off; }));
    EXPECT_EQ(plain.faces[0].status, "displaced");
    EXPECT_NEAR(plain.faces[0].offset_m, -off, 0.002);
    EXPECT_TRUE(plain.openings.empty());
    const auto pierced = find(scan([&](double x, double z) { return in_window(x, z) ? 3.0 : off; }));
    ASSERT_EQ(pierced.openings.size(), 1u) << off;
    EXPECT_FALSE(pierced.openings[0].cut);
    EXPECT_NE(pierced.openings[0].why_not.find("off its surface"), std::string::npos);
  }
}

TEST(Openings, a_face_that_stands_for_nothing_or_whose_half_lies_elsewhere_is_never_cut) {
  const auto absent = find(scan([](double, double) { return 2.0; }));
  for (const Opening& opening : absent.openings) EXPECT_FALSE(opening.cut);
  const auto half = find(scan([](double x, double) { return x < 1.9 ? 0.2 : 0.0; }));
  for (const Opening& opening : half.openings) EXPECT_FALSE(opening.cut) << opening.on_outline;
}

TEST(Openings, report_reports_and_few_rays_are_not_enough) {
  const Scene scene = scan([](double x, double z) { return in_window(x, z) ? 3.0 : 0.0; });
  const auto report = find(scene, "report");
  ASSERT_EQ(report.openings.size(), 1u);
  EXPECT_FALSE(report.openings[0].cut);
  OpeningOptions options;
  options.openings = "cut";
  options.opening_rays = 100000;
  EXPECT_TRUE(find_openings(wall_model(),
                            {{&scene.image, &scene.segmentation, nullptr, scene.pose, 0.001, {}}}, options)
                  .openings.empty());
}

TEST(Displacement, heights_over_the_face_where_it_was_measured) {
  const Scene scene = scan([](double x, double z) {
    if (in_window(x, z)) return 2.0;  // an opening: not measured
    return x > 3 ? -0.05 : 0.0;       // a pilaster, 5 cm proud
  });
  DisplacementOptions options;
  options.displacement_texel_m = 0.05;
  const auto maps = displacement_maps(
      wall_model(), {{&scene.image, &scene.segmentation, nullptr, scene.pose, 0.001, {}}}, options);
  ASSERT_EQ(maps.size(), 1u);
  const DisplacementMap& map = maps[0];
  EXPECT_EQ(map.cols, 80);
  EXPECT_EQ(map.rows, 60);
  const auto at = [&](double x, double z) {
    const int col = static_cast<int>(x / 0.05), row = 59 - static_cast<int>(z / 0.05);
    const auto i = static_cast<std::size_t>(row * 80 + col);
    const auto& m = map.world_from_texel;  // the texel's centre lies where it says
    EXPECT_NEAR(m[0] * col + m[1] * row + m[3], 0.05 * (col + 0.5), 1e-9);
    EXPECT_NEAR(m[8] * col + m[9] * row + m[11], 0.05 * (59 - row + 0.5), 1e-9);
    return map.height_m[i];
  };
  EXPECT_NEAR(at(0.5, 1.5), 0, 0.003);
  EXPECT_NEAR(at(3.5, 1.5), 0.05, 0.003);
  EXPECT_TRUE(std::isnan(at(1.5, 1.5)));
  EXPECT_NEAR(map.measured_m2, 12 - 1.4, 0.4);
}

}  // namespace hybrid::stages::openings_test
