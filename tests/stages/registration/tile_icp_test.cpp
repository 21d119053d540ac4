#include "stages/registration/tile_icp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cases/trial_room.hpp"

namespace hybrid::tile_icp_test {
namespace {

// Stars, of `corners` each, one in the other.
PolygonModel star_with_hole(std::uint32_t corners, double width_m) {
  PolygonModel model;
  Face face;
  for (const bool hole : {false, true}) {
    auto& ring = hole ? face.holes.emplace_back() : face.outer;
    for (std::uint32_t k = 0; k < corners; ++k) {
      const double angle = (hole ? -1 : 1) * 2 * M_PI * k / corners;
      const double radius = (hole ? 0.4 : 1) * (k % 2 ? 0.85 : 1) * width_m / 2;
      ring.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.emplace_back(radius * std::cos(angle), 0.3 * radius * std::sin(angle), 1.0);
    }
  }
  model.faces.push_back(face);
  return model;
}

}  // namespace

// Two faces back to back, two that lie in each other, and tiles all around.
TEST(TilePairs, starting_from_those_of_another_pose_finds_the_same) {
  PolygonModel model = star_with_hole(40, 8);
  model.faces.push_back(model.faces.front());
  const auto add = [&](double height, double shift) {
    const PolygonModel more = star_with_hole(40, 5);
    const auto first = static_cast<std::uint32_t>(model.vertices.size());
    for (Vec3 vertex : more.vertices) model.vertices.push_back(vertex + Vec3(shift, 0, height));
    Face face = more.faces.front();
    for (auto& v : face.outer) v += first;
    for (auto& v : face.holes[0]) v += first;
    model.faces.push_back(face);
  };
  add(0, 1);
  add(0.4, -1);
  const auto shapes = stages::measure_model(model);
  testing::Draw draw(7, 2);
  stages::ScanEvidence scan;
  for (int k = 0; k < 400; ++k) {
    stages::PlaneTile tile;
    tile.normal = Vec3::UnitZ();
    tile.area_m2 = 1;
    tile.centroid = Vec3(draw.within(-5, 5), draw.within(-2, 2), draw.within(0.5, 1.8));
    scan.tiles.push_back(tile);
  }
  Pose moved;
  moved.translation = Vec3(0.3, -0.2, 0.1);
  const auto last = stages::find_tile_pairs(scan, shapes, moved, 1.5);
  const auto fresh = stages::find_tile_pairs(scan, shapes, Pose(), 1.5),
             warm = stages::find_tile_pairs(scan, shapes, Pose(), 1.5, last);
  int paired = 0, changed = 0;
  for (std::size_t t = 0; t < fresh.size(); ++t) {
    EXPECT_EQ(warm[t].face, fresh[t].face) << t;
    EXPECT_EQ(warm[t].height_m, fresh[t].height_m) << t;
    paired += fresh[t].face != nullptr;
    changed += fresh[t].face != last[t].face;
  }
  EXPECT_GT(paired, 200);
  EXPECT_GT(changed, 20);
}

}  // namespace hybrid::tile_icp_test
