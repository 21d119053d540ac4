#include "batch/export/export_rib.hpp"

#include <OpenImageIO/imageio.h>

#include "batch/rib_reader.hpp"
#include "cases/holed_room.hpp"
#include "device.hpp"
#include "io/files.hpp"
#include "io/output.hpp"

namespace hybrid::testing {
namespace {

struct Exported {
  std::set<std::string> made;
  std::vector<std::string> notes;
  std::vector<io::SceneView> views;
};

Exported write(const std::filesystem::path& folder, const stages::RenderScene& scene,
               const std::string& samples) {
  Exported out;
  batch::PhotographSet photographs;
  photographs.cameras = scene.photographs;
  io::SceneView view;
  view.name = "a \"quoted\" view";
  view.eye = {5, 4, 2.4};
  view.target = {1, 2, 1};
  view.up = Vec3::UnitZ();
  view.fov_deg = 70;
  view.size = {120, 80};
  out.views.push_back(view);
  view.name = "through a distorted lens";
  view.photograph = scene.photographs.empty() ? "" : scene.photographs[0].name;
  if (!scene.photographs.empty()) out.views.push_back(view);
  batch::StageOptions options;
  options.exporting.rib_samples = samples;
  options.render.grazing_deg = 7.5;
  stages::Renderer renderer(queue(), scene);
  batch::write_rib_export(
      renderer, scene, out.views, photographs, options, folder,
      [&](const std::string& name) {
        out.made.insert(name);
        return folder / name;
      },
      [&](const std::string& note) { out.notes.push_back(note); });
  return out;
}

std::vector<float> native_depth(const stages::RenderScene& scene, const io::SceneView& view) {
  stages::ViewRequest request;
  request.camera = look_at(view.eye, view.target, view.up, view.fov_deg, view.size[0], view.size[1]);
  request.texture = false;
  return stages::Renderer(queue(), scene).render(request).depth_m;
}

}  // namespace

TEST(ExportRib, a_strict_reader_rebuilds_the_scene_and_sees_the_same_depths) {
  const RoomScene room = holed_room(2, 60, 45);
  for (const char* samples : {"points", "spheres"}) {
    const TemporaryFolder folder;
    const auto exported = write(folder.path(), room.scene, samples);
    const RibFile rib = read_rib(folder.path() / "scene.rib");
    EXPECT_EQ(rib.surface, "hybrid_blend");
    EXPECT_EQ(rib.surface_numbers.at("grazing_deg"), 7.5);
    ASSERT_EQ(rib.frames.size(), 1u);  // the distorted view has none, and a note says so
    ASSERT_EQ(exported.notes.size(), 1u);
    EXPECT_TRUE(holds(exported.notes[0], "through a distorted lens"));
    ASSERT_EQ(rib.polygons.size(), room.scene.proxy.faces.size());
    EXPECT_EQ(rib.polygons[4].rings.size(), 3u);
    EXPECT_EQ(rib.polygons[4].name, "face-4");
    ASSERT_EQ(rib.balls.size(), room.scene.splats.size());
    for (const auto& name : rib.files) EXPECT_TRUE(exported.made.count(name)) << name;
    for (const auto& name : exported.made) EXPECT_TRUE(name == "scene.rib" || rib.files.count(name)) << name;

    const auto expected = native_depth(room.scene, exported.views[0]);
    const auto found = rib.depth(rib.frames[0]);
    ASSERT_EQ(found.size(), expected.size());
    std::size_t off = 0, samples_seen = 0;
    double worst = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double difference = std::abs(found[i] - static_cast<double>(expected[i]));
      const bool both_nothing = std::isinf(found[i]) && std::isinf(expected[i]);
      if (both_nothing) continue;
      if (difference < 1e-4)
        worst = std::max(worst, difference);
      else
        ++off;  // on an outline
      for (const auto& ball : rib.balls)
        samples_seen +=
            std::abs(found[i] - (rib.frames[0].camera_from_world * ball.centre.homogeneous()).z()) <
            ball.radius;
    }
    EXPECT_LT(off, found.size() / 500);
    EXPECT_GT(samples_seen, 100u);
    RecordProperty("worst_depth_m", std::to_string(worst));
  }
}

TEST(ExportRib, projectors_stand_where_the_photographs_were_taken_and_see_what_they_saw) {
  const TemporaryFolder folder;
  const RoomScene room = holed_room(2, 60, 45);
  write(folder.path(), room.scene, "points");
  const RibFile rib = read_rib(folder.path() / "scene.rib");
  ASSERT_EQ(rib.lights.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& light = rib.lights[i];
    const Photograph& photograph = room.scene.photographs[i];
    EXPECT_LT((light.world_from_light.col(3).head<3>() - photograph.centre()).norm(), 1e-6);
    // A point of the room, through the light's matrix and the lens as the shader writes it.
    const Vec3 point(1.2, 3.1, 0.4);
    const Vec3 q = (light.world_from_light.inverse() * point.homogeneous()).head<3>();
    const auto expected = photograph.camera.project(photograph.cam_from_world * point);
    const double x = q.x() / q.z(), y = q.y() / q.z(), s = x * x + y * y;
    const auto& n = light.numbers;
    const double scale = 1 + s * (n.at("k1") + s * n.at("k2"));
    const double column = n.at("fx") * (x * scale + 2 * n.at("p1") * x * y) + n.at("cx");
    if (expected) {
      EXPECT_NEAR(column, expected->x(), 1e-3);
    }
    // The depth picture says what the pixel's ray meets.
    const auto picture =
        OIIO::ImageInput::open((folder.path() / "depth" / ("000" + std::to_string(i) + ".tif")).string());
    ASSERT_TRUE(picture);
    std::vector<float> depth(60 * 45);
    ASSERT_TRUE(picture->read_image(0, 0, 0, 1, OIIO::TypeFloat, depth.data()));
    std::size_t right = 0, hidden = 0;
    for (int row = 0; row < 45; ++row)
      for (int col = 0; col < 60; ++col) {
        const Vec3 ray = photograph.camera.ray({col + 0.5, row + 0.5});
        const auto [id, distance] =
            room.hit(photograph.centre(), photograph.cam_from_world.inverse().rotate(ray));
        const double value = static_cast<double>(depth[static_cast<std::size_t>(row * 60 + col)]);
        if (id == 0)
          right += value == 1e9;
        else if (value < ray.z() * distance - 0.01)
          ++hidden;  // by a sample, which the room's faces do not have
        else
          right += std::abs(value - ray.z() * distance) < 1e-3;
      }
    EXPECT_GT(right + hidden, 60u * 45u - 10u);
    EXPECT_LT(hidden, 200u);
  }
}

TEST(ExportRib, the_reader_rejects_what_is_wrong) {
  const TemporaryFolder folder;
  write(folder.path(), holed_room(1, 30, 20).scene, "points");
  const std::string scene = io::read_text(folder.path() / "scene.rib");
  const auto broken = [&](const std::string& from, const std::string& to) {
    std::string text = scene;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return folder.write("broken.rib", text);
  };
  EXPECT_NO_THROW(read_rib(broken("FrameEnd", "FrameEnd")));
  EXPECT_THROW(read_rib(broken("FrameEnd", "")), std::runtime_error);
  EXPECT_THROW(read_rib(broken("slides/0000.tif", "slides/0009.tif")), std::runtime_error);
  EXPECT_THROW(read_rib(broken("slides/0000.tex", "slides/0009.tex")), std::runtime_error);
  EXPECT_THROW(read_rib(broken("world.rib", "word.rib")), std::runtime_error);
  EXPECT_THROW(read_rib(broken("Format 120", "Format [120]")), std::runtime_error);
}

TEST(ExportRib, without_photographs_or_faces_says_so) {
  const TemporaryFolder folder;
  stages::RenderScene scene = holed_room(0, 1, 1).scene;
  EXPECT_TRUE(holds(write(folder.path(), scene, "points").notes.at(0), "no photographs"));
  EXPECT_EQ(read_rib(folder.path() / "scene.rib").lights.size(), 0u);
  scene.proxy = {};
  scene.splats.clear();
  const auto nothing = write(folder.path() / "nothing", scene, "points");
  EXPECT_TRUE(nothing.made.empty());
  EXPECT_TRUE(holds(nothing.notes.at(0), "no scene.rib"));
}

}  // namespace hybrid::testing
