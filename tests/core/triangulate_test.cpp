#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "geometry/keyhole.hpp"
#include "geometry/polygon_model.hpp"
#include "lib/random.h"

namespace hybrid::testing::triangulate_test {
namespace {

constexpr double kPi = std::numbers::pi;

// A face in a tilted plane far from the origin, so that nothing rests on axis-parallel or small numbers.
struct Drawing {
  PolygonModel model;
  Eigen::Quaterniond turn{Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized())};
  Vec3 shift{530000.25, 180000.5, 12.75};

  Drawing() { model.faces.push_back({"drawn", {}, {}}); }
  std::uint32_t add(double x, double y) {
    model.vertices.push_back(turn * Vec3(x, y, 0) + shift);
    return static_cast<std::uint32_t>(model.vertices.size() - 1);
  }
  Drawing& outer(const std::vector<std::array<double, 2>>& points) {
    for (const auto& p : points) model.faces[0].outer.push_back(add(p[0], p[1]));
    return *this;
  }
  Drawing& hole(const std::vector<std::array<double, 2>>& points) {
    model.faces[0].holes.emplace_back();
    for (const auto& p : points) model.faces[0].holes.back().push_back(add(p[0], p[1]));
    return *this;
  }
};

// Every triangle faces the front with a positive area, their areas add up, and no two overlap: the midpoints
// of a grid over the face lie in exactly as many triangles (0 or 1) as an even-odd test of the rings says.
void expect_partition(const Drawing& drawing, double expected_area, std::size_t expected_triangles = 0) {
  const auto triangles = triangulate(drawing.model);
  const Plane plane = face_plane(drawing.model, drawing.model.faces[0]);
  EXPECT_NEAR((plane.normal - drawing.turn * Vec3::UnitZ()).norm(), 0, 1e-8);
  EXPECT_NEAR(face_area_m2(drawing.model, drawing.model.faces[0]), expected_area, 1e-7 * expected_area);
  double sum = 0;
  auto flat = [&](std::uint32_t v) -> Vec3 {
    return drawing.turn.conjugate() * (drawing.model.vertices[v] - drawing.shift);
  };
  auto turn = [](const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a).z(); };
  for (const auto& t : triangles) {
    const double twice = turn(flat(t.vertices[0]), flat(t.vertices[1]), flat(t.vertices[2]));
    EXPECT_GT(twice, 0);
    EXPECT_EQ(t.face, 0u);
    sum += twice / 2;
  }
  EXPECT_NEAR(sum, expected_area, 1e-7 * expected_area);
  if (expected_triangles > 0) {
    EXPECT_EQ(triangles.size(), expected_triangles);
  }

  const Face& face = drawing.model.faces[0];
  Eigen::AlignedBox3d box;
  for (std::uint32_t v : face.outer) box.extend(flat(v));
  int inside_points = 0;
  for (int k = 0; k < 900; ++k) {
    const Vec3 p =
        box.min() + Vec3((k % 30 + 0.513) / 30 * box.sizes().x(), (k / 30 + 0.487) / 30 * box.sizes().y(), 0);
    bool inside = false;
    auto cross = [&](const std::vector<std::uint32_t>& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec3 a = flat(ring[i]), b = flat(ring[(i + 1) % ring.size()]);
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
          inside = !inside;
      }
    };
    cross(face.outer);
    for (const auto& hole : face.holes) cross(hole);
    int covering = 0;
    for (const auto& t : triangles) {
      const Vec3 a = flat(t.vertices[0]), b = flat(t.vertices[1]), c = flat(t.vertices[2]);
      covering += turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0;
    }
    EXPECT_EQ(covering, inside ? 1 : 0) << p.transpose();
    inside_points += inside;
  }
  EXPECT_GT(inside_points, 0);
}

void expect_refused(const PolygonModel& model, const std::string& part) {
  try {
    triangulate(model);
    ADD_FAILURE() << "accepted; expected an error with: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace

TEST(Triangulate, splits_concave_outlines) {
  expect_partition(Drawing().outer({{0, 0}, {4, 0}, {4, 3}, {0, 3}}), 12, 2);
  expect_partition(Drawing().outer({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}), 6, 4);
  expect_partition(Drawing().outer({{0, 0}, {5, 0}, {5, 4}, {4, 4}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}), 11, 6);
  Drawing comb;
  std::vector<std::array<double, 2>> teeth{{0, 0}, {19, 0}};
  for (int i = 9; i >= 0; --i) {
    teeth.push_back({2.0 * i + 1, 5});
    teeth.push_back({2.0 * i, 5});
    if (i > 0) teeth.push_back({2.0 * i, 1});
    if (i > 0) teeth.push_back({2.0 * i - 1, 1});
  }
  expect_partition(comb.outer(teeth), 19 * 1 + 10 * 4);
}

TEST(Triangulate, bridges_holes) {
  const std::vector<std::array<double, 2>> wall{{0, 0}, {10, 0}, {10, 4}, {0, 4}};
  expect_partition(Drawing().outer(wall).hole({{1, 1}, {1, 3}, {3, 3}, {3, 1}}), 36, 8);
  // Windows in a row at one height, whose bridges are collinear; one wound the wrong way round.
  expect_partition(Drawing()
                       .outer(wall)
                       .hole({{1, 1}, {1, 3}, {3, 3}, {3, 1}})
                       .hole({{4, 1}, {6, 1}, {6, 3}, {4, 3}})
                       .hole({{7, 1}, {7, 3}, {9, 3}, {9, 1}}),
                   28);
  // A hole whose corner is on the outline, and one behind a concave corner.
  expect_partition(Drawing().outer(wall).hole({{10, 2}, {9, 1.5}, {9, 2.5}}), 39.5);
  expect_partition(Drawing()
                       .outer({{0, 0}, {8, 0}, {8, 6}, {5, 6}, {5, 2}, {3, 2}, {3, 6}, {0, 6}})
                       .hole({{1, 4}, {1, 5}, {2, 5}, {2, 4}})
                       .hole({{6, 4}, {6, 5}, {7, 5}, {7, 4}}),
                   38);
}

// As contours have them: thousands of vertices, long sides beside short ones, and hundreds of holes, which
// the keyhole ring goes around, too.
TEST(Triangulate, takes_rough_outlines_with_many_holes) {
  const auto uniform = [](int item, std::uint32_t draw) {
    return random_bits(7, static_cast<std::uint32_t>(item), draw) / 4294967296.0;
  };
  Drawing drawing;
  std::vector<std::array<double, 2>> rough{{0, 0}, {60, 0}};
  double area = 60 * 9;
  for (int i = 0; i < 1200; ++i) {  // from the right to the left, ever another height
    const double left = 60 - 0.05 * (i + 1), height = 9 + uniform(i, 0);
    rough.push_back({left + 0.05, height});
    rough.push_back({left, height});
    area += 0.05 * (height - 9);
  }
  drawing.outer(rough);
  for (int row = 0; row < 8; ++row)
    for (int col = 0; col < 40; ++col) {
      const double x = 1.5 * col + 0.3 + 0.2 * uniform(row, 1), y = row + 0.5;
      drawing.hole({{x, y}, {x, y + 0.6}, {x + 0.7, y + 0.6}, {x + 0.7, y}});
      area -= 0.42;
    }
  expect_partition(drawing, area);

  const Face& face = drawing.model.faces[0];
  Face again{"again", keyhole_ring(drawing.model, face), {}};
  EXPECT_EQ(again.outer.size(), face.outer.size() + 320 * (4 + 2));
  split_keyholes(drawing.model, again);
  EXPECT_EQ(again.holes.size(), 320u);
  EXPECT_NEAR(face_area_m2(drawing.model, again), area, 1e-7 * area);
}

TEST(Triangulate, keeps_collinear_and_repeated_vertices_from_doing_harm) {
  expect_partition(Drawing().outer({{0, 0}, {1, 0}, {2, 0}, {4, 0}, {4, 3}, {2, 3}, {0, 3}, {0, 1}}), 12);
  expect_partition(Drawing().outer({{0, 0}, {4, 0}, {4, 0}, {4, 3}, {0, 3}, {0, 0}}), 12, 2);
  expect_partition(Drawing().outer({{0, 0}, {2, 0}, {4, 0}, {3, 1.5}, {2, 3}, {1, 1.5}}), 6);
}

TEST(Triangulate, splits_random_stars) {
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    auto uniform = [&](std::uint32_t draw) { return random_bits(5, trial, draw) / 4294967296.0; };
    const int count = 5 + static_cast<int>(random_below(5, trial, 0, 40));
    Drawing star;
    std::vector<std::array<double, 2>> points;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * kPi * (i + 0.8 * uniform(static_cast<std::uint32_t>(2 * i + 1))) / count;
      const double radius = 1 + 4 * uniform(static_cast<std::uint32_t>(2 * i + 2));
      points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    star.outer(points);
    double area = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto &a = points[i], &b = points[(i + 1) % points.size()];
      area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    if (trial % 2) {  // gaps reach 130 degrees, so the sides stay 0.42 from the middle
      star.hole({{0.1, 0.1}, {0.1, -0.1}, {-0.1, -0.1}, {-0.1, 0.1}});
      area -= 0.04;
    }
    SCOPED_TRACE(trial);
    expect_partition(star, area, points.size() - 2 + (trial % 2 ? 6 : 0));
  }
}

TEST(Triangulate, refuses_what_is_no_polygon_and_names_it) {
  expect_refused(Drawing().outer({{0, 0}, {1, 0}, {3, 0}}).model,
                 "face drawn: expected a polygon with an area");
  expect_refused(Drawing().outer({{1, 1}, {1, 1}, {1, 1}}).model,
                 "face drawn: expected a polygon with an area");
  expect_refused(Drawing().outer({{0, 0}, {1, 0}}).model,
                 "expected at least 3 vertices in its outline, found 2");
  expect_refused(Drawing().outer({{0, 0}, {4, 4}, {4, 0}, {0, 3}}).model, "crosses itself");
  expect_refused(Drawing().outer({{0, 0}, {4, 0}, {4, 3}, {0, 3}}).hole({{5, 1}, {5, 2}, {6, 2}}).model,
                 "face drawn");
  expect_refused(Drawing().outer({{0, 0}, {4, 0}, {4, 3}, {0, 3}}).hole({{3, 1}, {3, 2}, {6, 2}}).model,
                 "face drawn");
  Drawing index;
  index.outer({{0, 0}, {4, 0}, {4, 3}});
  index.model.faces[0].outer[1] = 17;
  expect_refused(index.model, "vertex index 17 in its outline, but the model has 3 vertices");
  Drawing infinite;
  infinite.outer({{0, 0}, {4, 0}, {4, 3}});
  infinite.model.vertices[2].y() = std::nan("");
  expect_refused(infinite.model, "vertex 2 of its outline is not finite");
}

TEST(Triangulate, an_empty_model_has_no_triangles) {
  EXPECT_TRUE(triangulate({}).empty());
}

}  // namespace hybrid::testing::triangulate_test
