#include "stages/editing/edit_model.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

// A wall of 4 x 3 m seen from -y, and a floor before it.
PolygonModel wall_and_floor() {
  PolygonModel model;
  model.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 0, 3}, {0, 0, 3}, {0, -4, 0}, {4, -4, 0}};
  model.faces = {{"wall", {0, 1, 2, 3}, {}}, {"floor", {4, 5, 1, 0}, {}}};
  return model;
}

std::string error_of_hole(const Ring2& ring, std::vector<Ring2> before = {}) {
  PolygonModel model = wall_and_floor();
  for (const Ring2& hole : before) cut_hole(model, 0, hole);
  const auto vertices = model.vertices.size();
  try {
    cut_hole(model, 0, ring);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(model.vertices.size(), vertices);  // nothing half done
    return error.what();
  }
  return "";
}

Ring2 box(double left, double low, double right, double high) {
  return {{left, low}, {right, low}, {right, high}, {left, high}};
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(EditModel, face_coordinates_run_right_and_up_from_the_lower_left_corner) {
  const PolygonModel model = wall_and_floor();
  const FaceFrame frame = face_frame(model, model.faces[0]);
  EXPECT_TRUE(frame.u.isApprox(Vec3::UnitX()));
  EXPECT_TRUE(frame.v.isApprox(Vec3::UnitZ()));
  EXPECT_TRUE(frame.world({1, 2}, 0.5).isApprox(Vec3(1, -0.5, 2)));
  EXPECT_TRUE(frame.size.isApprox(Vec2(4, 3)));
  EXPECT_TRUE(frame.flat({1, -7, 2}).isApprox(Vec2(1, 2)));
}

TEST(EditModel, a_hole_takes_its_area_whichever_way_it_runs) {
  for (const bool turned : {false, true}) {
    PolygonModel model = wall_and_floor();
    Ring2 ring = box(1, 1, 2, 2.5);
    if (turned) std::reverse(ring.begin(), ring.end());
    cut_hole(model, 0, ring);
    EXPECT_NEAR(face_area_m2(model, model.faces[0]), 12 - 1.5, 1e-9);
    EXPECT_TRUE(can_be_triangulated(model));
  }
}

TEST(EditModel, a_door_may_stand_on_the_edge) {
  PolygonModel model = wall_and_floor();
  cut_hole(model, 0, box(1, 0, 2, 2));
  cut_hole(model, 0, box(3, -0.003, 4.003, 2));  // in the corner, a little over both edges
  EXPECT_NEAR(face_area_m2(model, model.faces[0]), 12 - 4, 0.02);
  EXPECT_TRUE(can_be_triangulated(model));
}

TEST(EditModel, wrong_holes_are_errors_that_say_why) {
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {2, 2}}), "at least 3 vertices"));
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {2, 2}, {1, 2}, {2, 1}}), "meets itself"));
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {2, 1}, {2, 1}, {1, 2}}),
                   "found vertex 1 at (2, 1) again as vertex 2; remove one of them"));
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {2, 1}, {2, 2}, {1, 1}}), "the polygon closes by itself"));
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {2, 1.1}, {3, 1.2}}), "all 3 vertices on one line"));
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {3, 1}, {2, 1}, {2, 2}}),
                   "runs back over the one before it, at vertex 1 at (3, 1); remove that vertex"));
  EXPECT_TRUE(says(error_of_hole(box(3, 1, 4.5, 2)), "vertex 1 at (4.500, 1.000) lies outside face wall"));
  EXPECT_TRUE(says(error_of_hole(box(5, 1, 6, 2)), "lies outside face wall"));
  EXPECT_TRUE(says(error_of_hole(box(1.5, 1.5, 3, 2.5), {box(1, 1, 2, 2)}), "overlaps hole 1"));
  EXPECT_TRUE(says(error_of_hole(box(1.2, 1.2, 1.8, 1.8), {box(1, 1, 2, 2)}), "overlaps hole 1"));
  EXPECT_TRUE(says(error_of_hole(box(0.5, 0.5, 2.5, 2.5), {box(1, 1, 2, 2)}), "overlaps hole 1"));
  EXPECT_TRUE(says(error_of_hole({{1, 1}, {2, std::nan("")}, {1, 2}}), "finite"));
  EXPECT_EQ(error_of_hole(box(2.2, 1, 3, 2), {box(1, 1, 2, 2)}), "");
}

TEST(EditModel, world_points_must_lie_on_the_face) {
  const PolygonModel model = wall_and_floor();
  const FaceFrame frame = face_frame(model, model.faces[0]);
  EXPECT_TRUE(ring_on_face(frame, {{1, 0.01, 2}})[0].isApprox(Vec2(1, 2)));
  EXPECT_THROW(ring_on_face(frame, {{1, 0.2, 2}}), Error);
}

TEST(EditModel, removed_faces_leave_the_vertices) {
  const PolygonModel model = wall_and_floor();
  const PolygonModel edited = without_faces(model, {true, false});
  ASSERT_EQ(edited.faces.size(), 1u);
  EXPECT_EQ(edited.faces[0].name, "floor");
  EXPECT_EQ(edited.vertices.size(), model.vertices.size());
  EXPECT_THROW(without_faces(model, {true, true}), Error);
}

TEST(FlatRing, simplified_keeps_corners_and_drops_what_lies_between) {
  Ring2 ring;
  for (int k = 0; k < 10; ++k) ring.emplace_back(0.1 * k, 0.001 * (k % 2));
  for (int k = 0; k < 10; ++k) ring.emplace_back(1, 0.1 * k);
  ring.emplace_back(0.0, 1.0);
  const Ring2 simple = simplified(ring, 0.01);
  EXPECT_NEAR(signed_area(simple), signed_area(ring), 0.06);
  EXPECT_LE(simple.size(), 6u);
}

}  // namespace hybrid::stages
