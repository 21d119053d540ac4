// Polygons, borders and openings where the answer is plain.
#include <gtest/gtest.h>

#include "score/measure/boundary.hpp"
#include "score/measure/coplanar_pieces.hpp"
#include "score/measure/cylinders.hpp"
#include "score/measure/labels.hpp"
#include "score/measure/openings.hpp"
#include "score/measure/plane_list.hpp"
#include "score/measure/polygon.hpp"
#include "score/read/camera.hpp"

namespace score_tests {
namespace {

using score::Vec3;

std::vector<Vec3> square(double low, double high, double z = 0) {
  return {{low, low, z}, {high, low, z}, {high, high, z}, {low, high, z}};
}

// One row: plane 1 to `border`, plane 2 after it; the result has its border at `found`.
score::JoinedScan row_of(int cols, int border, int found, bool wraps) {
  score::JoinedScan scan;
  scan.rows = 1;
  scan.cols = cols;
  scan.wraps = wraps;
  scan.min_samples = 1;
  for (int col = 0; col < cols; ++col) {
    scan.plane.push_back(col < border ? 1 : 2);
    scan.kind.push_back(score::kPlanar);
    scan.label.push_back(col < found ? 7 : 8);
    ++scan.plane_size[scan.plane.back()];
  }
  return scan;
}

// Twelve samples a plane: planes 1 and 2 are pieces of z = 0, plane 3 lies 5 mm above them. `label`: by
// plane.
score::JoinedScan three_planes(const std::array<std::uint32_t, 3>& label) {
  score::JoinedScan scan;
  scan.rows = 1;
  scan.cols = 36;
  scan.min_samples = 1;
  for (std::uint32_t i = 0; i < 36; ++i) {
    scan.plane.push_back(1 + i / 12);
    scan.kind.push_back(score::kPlanar);
    scan.label.push_back(label[i / 12]);
  }
  scan.plane_size = {{1, 12}, {2, 12}, {3, 12}};
  score::join_coplanar_pieces({{1, {1, "a", {Vec3::UnitZ(), 0}}},
                               {2, {2, "b", {Vec3::UnitZ(), 0}}},
                               {3, {3, "c", {Vec3::UnitZ(), 0.005}}}},
                              scan);
  return scan;
}

}  // namespace

TEST(CoplanarPieces, one_region_makes_them_one_plane) {
  const auto score = score::score_labels(three_planes({7, 7, 8}));
  EXPECT_EQ(score.planes, 2);
  EXPECT_EQ(score.found, 2);
  EXPECT_EQ(score.right, 36);
}

TEST(CoplanarPieces, apart_in_the_result_they_stay_apart) {
  const auto score = score::score_labels(three_planes({7, 9, 8}));
  EXPECT_EQ(score.planes, 3);
  EXPECT_EQ(score.found, 3);
  EXPECT_EQ(score.right, 36);
}

TEST(CoplanarPieces, a_step_of_5_mm_is_none) {
  const auto score = score::score_labels(three_planes({7, 8, 7}));
  EXPECT_EQ(score.planes, 3);
  EXPECT_EQ(score.found, 2);
  EXPECT_EQ(score.right, 24);
}

TEST(CoplanarPieces, half_a_piece_is_not_held) {
  auto scan = three_planes({7, 9, 8});
  for (std::size_t i = 12; i < 18; ++i) scan.label[i] = 7;
  score::join_coplanar_pieces({{1, {1, "a", {Vec3::UnitZ(), 0}}}, {2, {2, "b", {Vec3::UnitZ(), 0}}}}, scan);
  EXPECT_EQ(scan.plane_size.size(), 3u);
}

TEST(Polygon, distance_to_a_square_with_a_hole) {
  const score::PlanePolygon polygon({Vec3::UnitZ(), 0}, {square(0, 10), square(4, 6)});
  EXPECT_DOUBLE_EQ(polygon.distance_m({2, 2, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(polygon.distance_m({5, 5.25, 0}), 0.75);  // in the hole
  EXPECT_DOUBLE_EQ(polygon.distance_m({13, 14, 0}), 5);      // off a corner
  EXPECT_DOUBLE_EQ(polygon.distance_m({13, 5, 4}), 5);       // off an edge and the plane
  EXPECT_TRUE(polygon.covers(Vec3(1, 9, 100)));
  EXPECT_FALSE(polygon.covers(Vec3(-1, 5, 0)));
  EXPECT_FALSE(score::PlanePolygon({Vec3::UnitZ(), 0}, {}).covers(Vec3(0, 0, 0)));
}

TEST(Cylinders, only_axes_in_the_middle_of_a_true_column_count) {
  const std::vector<score::TrueSolid> solids = {{"shown", "cylinder", {1, 1, 0}, {2, 2, 3}},
                                                {"hidden", "cylinder", {5, 1, 0}, {6, 2, 3}},
                                                {"font", "turned", {1, 5, 0}, {2, 6, 1}}};
  score::LabelledGrid grid;
  score::TrueSamples samples;
  for (std::uint32_t i = 0; i < 100; ++i) {
    grid.source.push_back(i);
    grid.point.emplace_back(1.0f, 1.5f, 0.03f * static_cast<float>(i));
    samples.kind.push_back(score::kCurved);
  }
  const score::ResultCylinder right{{1.51, 1.5, 0.2}, Vec3::UnitZ(), 2, 0.5},
      beside{{1.6, 1.5, 0.2}, Vec3::UnitZ(), 2, 0.5}, font{{1.5, 5.5, 0.1}, Vec3::UnitZ(), 0.5, 0.2},
      leaning{{1.5, 1.5, 0.2}, Vec3(0.1, 0, 1).normalized(), 2, 0.5};
  const auto of = [&](const std::vector<score::ResultCylinder>& cylinders) {
    return score::score_cylinders(grid, samples, solids, {}, cylinders, 100);
  };
  const auto good = of({right, font});
  EXPECT_EQ(good.shown, 1);
  EXPECT_EQ(good.found, 1);
  EXPECT_EQ(good.invented, 0);
  EXPECT_NEAR(good.axis_off_mm.value(), 10, 1e-9);
  const auto bad = of({beside, leaning});
  EXPECT_EQ(bad.found, 0);
  EXPECT_EQ(bad.invented, 2);
  EXPECT_FALSE(bad.axis_off_mm.has_value());
}

TEST(Boundary, a_border_three_samples_off) {
  const auto score = score::score_boundaries(row_of(100, 50, 53, false));
  EXPECT_EQ(score.displaced.borders, 2);  // one for either plane
  EXPECT_DOUBLE_EQ(score.displaced.median, 3);
  EXPECT_DOUBLE_EQ(score.invented.median, 3);
  EXPECT_DOUBLE_EQ(score.displaced.share_beyond_1, 1);
}

TEST(Boundary, the_seam_is_no_end) {
  const auto open = score::score_boundaries(row_of(100, 50, 50, false));
  EXPECT_EQ(open.displaced.borders, 2);
  const auto closed = score::score_boundaries(row_of(100, 50, 50, true));
  EXPECT_EQ(closed.displaced.borders, 4);  // the last column is next to the first
  EXPECT_DOUBLE_EQ(closed.displaced.percentile_95, 0);
}

TEST(Boundary, gaps_and_mixed_samples_are_stepped_over) {
  auto scan = row_of(100, 50, 50, false);
  scan.kind[50] = score::kMixed;
  scan.kind[51] = score::kNotMeasured;
  scan.label[50] = 7;  // what becomes of a mixed sample is no matter of borders
  const auto score = score::score_boundaries(scan);
  EXPECT_EQ(score.displaced.borders, 2);
  EXPECT_DOUBLE_EQ(score.displaced.percentile_95, 0);
}

TEST(Boundary, a_hole_inside_a_plane_is_invented) {
  auto scan = row_of(100, 50, 50, false);
  scan.label[20] = 0;
  const auto score = score::score_boundaries(scan);
  EXPECT_DOUBLE_EQ(score.displaced.percentile_95, 0);
  EXPECT_EQ(score.invented.borders, 4);
  EXPECT_GT(score.invented.percentile_95, 25);
}

TEST(Openings, half_of_an_opening_is_closed) {
  const std::vector<score::TrueOpening> truth = {{"window", "floor", square(1, 2)}};
  score::EditedModel edited;
  edited.polygons = {
      {{0, 0, 0.05}, {1.5, 0, 0.05}, {1.5, 5, 0.05}, {0, 5, 0.05}},  // 5 cm off: the face all the same
      square(0, 5, 1.0)};                                            // another face, a metre away
  const auto score = score::score_openings(truth, edited, {});
  EXPECT_NEAR(*score.openings[0].open_share, 0.5, 0.03);
  EXPECT_FALSE(score.openings[0].reported_share);
  EXPECT_FALSE(score.wrongly_open_m2);
}

TEST(Camera, ray_and_pixel_are_inverse) {
  const auto camera =
      score::json_camera({{"name", "a"},
                          {"size_px", {640, 480}},
                          {"model", "RADIAL"},
                          {"parameters", {500.0, 321.0, 242.0, -0.06, 0.02}},
                          {"world_from_camera", {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1}}});
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, {321.0, 242.0}, {639.5, 479.5}, {100.0, 400.0}}) {
    const auto pixel = camera.pixel_of(camera.eye + 3 * camera.ray(x, y));
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), x, 1e-9);
    EXPECT_NEAR(pixel->y(), y, 1e-9);
  }
  EXPECT_FALSE(camera.pixel_of(camera.eye - Vec3::UnitZ()));
}

TEST(Geometry, poses_that_are_none_are_refused) {
  EXPECT_THROW(score::similarity_from_row_major({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1}),
               std::runtime_error);
  EXPECT_THROW(score::similarity_from_row_major({1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
               std::runtime_error);
  EXPECT_THROW(score::similarity_from_row_major({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1}),
               std::runtime_error);
  const auto pose = score::similarity_from_row_major({0, -2, 0, 5, 2, 0, 0, 6, 0, 0, 2, 7, 0, 0, 0, 1});
  EXPECT_NEAR(pose.scale, 2, 1e-12);
  EXPECT_NEAR(score::rotation_angle_deg(pose.rotation), 90, 1e-9);
}

TEST(PlaneList, says_what_keeps_a_plane_and_its_region_apart) {
  score::JoinedScan scan = row_of(20, 10, 7, false);  // plane 1: 7 samples in region 7, 3 in region 8
  scan.kind[18] = score::kCurved;
  scan.kind[19] = score::kMixed;
  scan.label[0] = 0;
  scan.plane[18] = scan.plane[19] = 0;
  const auto list = score::list_planes(scan);
  ASSERT_EQ(list.size(), 2u);
  const score::PlaneRow &first = list[0], &second = list[1];
  EXPECT_EQ(first.plane, 1u);
  EXPECT_EQ(first.region, 7u);
  EXPECT_EQ(first.unlabelled, 1);
  EXPECT_EQ(first.strangers, 0);
  EXPECT_DOUBLE_EQ(first.share_of_plane(), 0.6);
  EXPECT_DOUBLE_EQ(first.share_of_region(), 1);
  EXPECT_EQ(second.region, 8u);
  EXPECT_EQ(second.strangers, 3);
  EXPECT_EQ(second.curved, 1);
  EXPECT_EQ(second.mixed, 1);
  EXPECT_DOUBLE_EQ(second.share_of_plane(), 1);
  EXPECT_DOUBLE_EQ(second.share_of_region(), 8.0 / 13);
}

}  // namespace score_tests
