#include "io/models/obj.hpp"

#include <gtest/gtest.h>

#include "geometry/keyhole.hpp"
#include "io/files.hpp"

namespace hybrid::io::obj_test {
namespace {
using testing::error_of;
using testing::holds;
using testing::real_data;
using testing::TemporaryFolder;
using Ring = std::vector<std::uint32_t>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

PolygonModel read_text_obj(const TemporaryFolder& folder, const std::string& text) {
  return read_obj(folder.write("model.obj", text));
}

TEST(obj, reads_polygons_of_any_size_and_every_corner_form) {
  const TemporaryFolder folder;
  const auto model =
      read_text_obj(folder, kSquare +
                                "v 0.5 1.5 0\nvt 0 0\nvn 0 0 1\n"
                                "f 1 2 3\nf 1/1 2/1 3/1 4/1\nf 1//1 2//1 3//1 5//1 4//1 # gable\n"
                                "f +1/1/1 2/1/1 3/1/1\n");
  ASSERT_EQ(model.faces.size(), 4u);
  EXPECT_EQ(model.faces[0].outer, (Ring{0, 1, 2}));
  EXPECT_EQ(model.faces[1].outer, (Ring{0, 1, 2, 3}));
  EXPECT_EQ(model.faces[2].outer, (Ring{0, 1, 2, 4, 3}));
  EXPECT_EQ(model.faces[3].outer, (Ring{0, 1, 2}));
}

TEST(obj, negative_indices_count_from_the_vertices_so_far) {
  const TemporaryFolder folder;
  const auto model = read_text_obj(folder, kSquare + "f -4 -3 -2\nv 9 9 9\nf -5/-1 -4 -1\n");
  EXPECT_EQ(model.faces[0].outer, (Ring{0, 1, 2}));
  EXPECT_EQ(model.faces[1].outer, (Ring{0, 1, 4}));
}

TEST(obj, forward_references_and_continued_lines) {
  const TemporaryFolder folder;
  const auto model = read_text_obj(folder, "f 1 2 \\\r\n 3 \\\r\n 4\r\n" + kSquare + "f 4 3 2\n");
  EXPECT_EQ(model.faces[0].outer, (Ring{0, 1, 2, 3}));
  EXPECT_EQ(model.faces[1].outer, (Ring{3, 2, 1}));
}

TEST(obj, the_last_of_group_object_and_material_names_a_face) {
  const TemporaryFolder folder;
  const auto model =
      read_text_obj(folder, kSquare +
                                "f 1 2 3\no house\nf 1 2 3\ng west wall \nf 1 2 3\nf 1 3 4\n"
                                "usemtl stone\nf 1 2 3\ng west wall\nf 2 3 4\ng west wall-2\nf 1 2 4\n"
                                "g\nf 1 2 3\n");
  std::vector<std::string> names;
  for (const Face& face : model.faces) names.push_back(face.name);
  // "west wall-2" is the file's own name for a later face, so the second "west wall" may not take it.
  EXPECT_EQ(names, (std::vector<std::string>{"face-0", "house", "west wall", "west wall-3", "stone",
                                             "west wall-4", "west wall-2", "face-7"}));
}

TEST(obj, scale_and_axes) {
  const TemporaryFolder folder;
  const auto file = folder.write("model.obj", "v 1000 2000 3000\nv 0 0 0\nv 1 0 0\nf 1 2 3\n");
  EXPECT_EQ(read_obj(file, 0.001).vertices[0], Vec3(1, 2, 3));
  EXPECT_EQ(read_obj(file, 0.001, true).vertices[0], Vec3(1, -3, 2));  // y up: height 2 becomes z
}

TEST(obj, colours_and_unit_weights_are_accepted) {
  const TemporaryFolder folder;
  const auto model = read_text_obj(folder, "v 1 2 3 0.5 0.5 0.5\nv 4 5 6 1\nv 7 8 10\nf 1 2 3\n");
  EXPECT_EQ(model.vertices[0], Vec3(1, 2, 3));
  EXPECT_EQ(model.vertices[1], Vec3(4, 5, 6));
}

struct Broken {
  std::string text;
  int line;
  std::string part;
};

TEST(obj, errors_name_the_line) {
  const TemporaryFolder folder;
  const std::vector<Broken> cases = {
      {kSquare + "f 1 2 5\n", 5, "expected a vertex from 1 to 4, found 5"},
      {kSquare + "f 1 2 0\n", 5, "found 0"},
      {kSquare + "f 1 2 -5\n", 5, "found -5"},
      {kSquare + "f 1 2 99999999999\n", 5, "found 99999999999"},
      {kSquare + "f 1 2\n", 5, "at least 3 different vertices"},
      {kSquare + "f 1 2 2 1\n", 5, "at least 3 different vertices"},
      {kSquare + "f 1 2 3x\n", 5, "found \"3x\""},
      {kSquare + "f 1 2 3/\n", 5, "found \"3/\""},
      {kSquare + "f 1 2 3//\n", 5, "found \"3//\""},
      {kSquare + "f 1 2 3/1/1/1\n", 5, "found \"3/1/1/1\""},
      {kSquare + "f 1 2 /3\n", 5, "found \"/3\""},
      {kSquare + "f 1 2 \\\n3 7\n", 5, "found 7"},
      {"v 1 2\n", 1, "found 2 numbers"},
      {"v 1 2 3 4 5\n", 1, "found 5 numbers"},
      {"v 1 2 nan\n", 1, "expected a finite number, found \"nan\""},
      {"v 1 2 1e999\n", 1, "expected a finite number"},
      {"v 1 2 3,5\n", 1, "found \"3,5\""},
      {"v 1 2 3 0.5\n", 1, "expected w = 1"},
      {kSquare, 4, "at least one face"},
      {kSquare + "curv 0 1 1 2\n", 5, "export polygons"},
  };
  for (const Broken& broken : cases) {
    SCOPED_TRACE(broken.text);
    const std::string message = error_of(ErrorKind::input, [&] { read_text_obj(folder, broken.text); });
    EXPECT_TRUE(holds(message, "model.obj:" + std::to_string(broken.line) + ": "));
    EXPECT_TRUE(holds(message, broken.part));
  }
}

TEST(obj, scale_must_be_positive) {
  const TemporaryFolder folder;
  const auto file = folder.write("model.obj", kSquare + "f 1 2 3\n");
  for (double scale : {0.0, -1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)})
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_obj(file, scale); }), "scale"));
}

void expect_same(const PolygonModel& a, const PolygonModel& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i) EXPECT_EQ(a.vertices[i], b.vertices[i]);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    EXPECT_EQ(a.faces[i].name, b.faces[i].name);
    EXPECT_EQ(a.faces[i].outer, b.faces[i].outer);
    EXPECT_EQ(a.faces[i].holes.size(), b.faces[i].holes.size());
  }
}

TEST(obj, written_models_read_back_bit_for_bit) {
  const TemporaryFolder folder;
  PolygonModel model;
  model.vertices = {{530000.1, 1.0 / 3, -0.0}, {1e-300, 2, 3}, {4, 0.1 + 0.2, 6}, {-7.25, 8, 1e22}};
  model.faces = {{"a wall", {0, 1, 2}, {}}, {"roof-2", {3, 2, 1, 0}, {}}, {"face-2", {1, 2, 3}, {}}};
  write_obj(folder.path() / "out/written.obj", model);
  expect_same(read_obj(folder.path() / "out/written.obj"), model);
}

// A wall of 10 x 4 with a door standing free of the floor and two windows.
PolygonModel wall_with_holes() {
  PolygonModel model;
  const auto rectangle = [&](double x0, double z0, double x1, double z1) {
    const auto first = static_cast<std::uint32_t>(model.vertices.size());
    for (const auto& [x, z] : {std::pair{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}})
      model.vertices.push_back({x, 2, z});
    return first;
  };
  const auto ring = [](std::uint32_t first, bool clockwise) {
    return clockwise ? Ring{first, first + 3, first + 2, first + 1}
                     : Ring{first, first + 1, first + 2, first + 3};
  };
  Face wall{"wall", ring(rectangle(0, 0, 10, 4), false), {}};
  for (double x : {1.0, 4.0, 7.0}) wall.holes.push_back(ring(rectangle(x, 1, x + 2, 3), true));
  model.faces = {wall};
  return model;
}

double area(const PolygonModel& model, const Ring& ring) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i)
    sum += model.vertices[ring[i]].cross(model.vertices[ring[(i + 1) % ring.size()]]);
  return 0.5 * sum.norm();
}

// The same cycle whatever vertex it starts at.
Ring from_smallest(Ring ring) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  return ring;
}

TEST(obj, holes_are_written_as_keyholes_and_found_again) {
  const TemporaryFolder folder;
  const PolygonModel model = wall_with_holes();
  const Ring joined = keyhole_ring(model, model.faces[0]);
  EXPECT_EQ(joined.size(), 4u + 3 * (4 + 2));
  EXPECT_DOUBLE_EQ(area(model, joined), 40 - 3 * 4.0);  // what a program that knows no holes sees
  write_obj(folder.path() / "wall.obj", model);
  const PolygonModel back = read_obj(folder.path() / "wall.obj");
  ASSERT_EQ(back.faces.size(), 1u);
  EXPECT_EQ(from_smallest(back.faces[0].outer), model.faces[0].outer);
  std::vector<Ring> found;
  for (const Ring& hole : back.faces[0].holes) found.push_back(from_smallest(hole));
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, model.faces[0].holes);
}

TEST(obj, a_hole_outside_its_face_is_an_error) {
  const TemporaryFolder folder;
  PolygonModel model = wall_with_holes();
  for (std::size_t i = 4; i < 8; ++i) model.vertices[i].x() += 50;
  const std::string message =
      error_of(ErrorKind::input, [&] { write_obj(folder.path() / "wall.obj", model); });
  EXPECT_TRUE(holds(message, "face wall"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "wall.obj"));
}

TEST(obj, a_spike_is_taken_off) {
  const TemporaryFolder folder;
  const auto model = read_text_obj(folder, kSquare + "v 2 2 0\nf 1 2 3 5 3 4\n");
  EXPECT_EQ(from_smallest(model.faces[0].outer), (Ring{0, 1, 2, 3}));
  EXPECT_TRUE(model.faces[0].holes.empty());
}

TEST(obj, real_files) {
  const auto folder = real_data("formats/pdal/obj");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const auto box = read_obj(folder / "box.obj");
  EXPECT_EQ(box.vertices.size(), 8u);
  EXPECT_EQ(box.faces.size(), 6u);
  EXPECT_EQ(box.faces[0].outer, (Ring{3, 2, 1, 0}));
  EXPECT_EQ(box.faces[5].name, "Default-6");
  const auto texture = read_obj(folder / "box_texture.obj");
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(texture.faces[i].outer, box.faces[i].outer);
  const auto coloured = read_obj(folder / "1.2-with-color.obj");
  EXPECT_EQ(coloured.vertices.size(), 911u);
  EXPECT_EQ(coloured.faces.size(), 1672u);
  EXPECT_EQ(coloured.vertices[0], Vec3(636896.3125, 849087.6875, 446.390015));
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { read_obj(folder / "hyper_box.obj"); }), "expected w = 1"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_obj(folder / "no_vertex.obj"); }), "one face"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_obj(folder / "simple_binary.obj"); }), "one face"));
}

}  // namespace
}  // namespace hybrid::io::obj_test
