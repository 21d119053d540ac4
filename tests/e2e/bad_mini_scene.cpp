#include "bad_mini_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "geometry/camera.hpp"
#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "io/ply/ply.hpp"
#include "places.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

const Vec3 kRoom_m(4.0, 3.0, 2.5);  // from the origin

// Distance from inside the room to its boundary.
double range_m(const Vec3& from, const Vec3& direction) {
  double nearest = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double wall = direction[axis] > 0 ? kRoom_m[axis] : 0;
    if (std::abs(direction[axis]) > 1e-12) nearest = std::min(nearest, (wall - from[axis]) / direction[axis]);
  }
  return nearest;
}

// The scanner's axes are the world's: world_from_scan is the translation to kScanner_m.
void write_scan(const fs::path& file) {
  std::vector<io::PlyPoint> points;
  for (int row = 0; row < 60; ++row)
    for (int col = 0; col < 120; ++col) {
      const double elevation = (row - 29.5) * std::numbers::pi / 72, azimuth = col * std::numbers::pi / 60;
      const Vec3 direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                           std::sin(elevation));
      const Vec3 point = range_m(kScanner_m, direction) * direction;
      points.push_back({{point.x(), point.y(), point.z()}});
    }
  io::write_ply(file, points, {});
}

void write_proxy(const fs::path& file) {
  std::string text;
  for (int corner = 0; corner < 8; ++corner)
    text += fmt::format("v {} {} {}\n", corner & 1 ? kRoom_m.x() : 0, corner & 2 ? kRoom_m.y() : 0,
                        corner & 4 ? kRoom_m.z() : 0);
  io::write_text(file, text + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n");
}

void write_photographs(const fs::path& folder) {
  std::string cameras, images;
  for (int i = 0; i < 2; ++i) {
    const auto photograph = look_at({0.6, 0.5 + i, 1.3}, {3.5, 2.0, 1.1}, Vec3::UnitZ(), 60, 64, 48);
    const auto& q = photograph.cam_from_world.rotation;
    const auto& t = photograph.cam_from_world.translation;
    const auto& c = photograph.camera;
    cameras += fmt::format("{} PINHOLE 64 48 {} {} {} {}\n", i + 1, c.fx, c.fy, c.cx, c.cy);
    images += fmt::format("{} {} {} {} {} {} {} {} {} {}.png\n\n", i + 1, q.w(), q.x(), q.y(), q.z(), t.x(),
                          t.y(), t.z(), i + 1, i);
    Image8 picture(64, 48, 3);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        picture.at(x, y)[0] = static_cast<std::uint8_t>(60 + 2 * x);
        picture.at(x, y)[1] = static_cast<std::uint8_t>(60 + 3 * y);
        picture.at(x, y)[2] = 120;
      }
    io::write_png(folder / "images" / fmt::format("{}.png", i), picture);
  }
  io::write_text(folder / "cameras/cameras.txt", cameras);
  io::write_text(folder / "cameras/images.txt", images);
}

}  // namespace

std::string mini_scene_text() {
  // As long as a reference system in WKT is: summary.json takes more pages of a disk than timing.json.
  const std::string crs(3000, 'x');
  return R"([scene]
name = "mini"
levelled = true
crs = ")" +
         crs + R"("

[[scan]]
id = "s"
file = "s.ply"
pose = [1, 0, 0, 1.61, 0, 1, 0, 1.29, 0, 0, 1, 1.2, 0, 0, 0, 1]

[model]
file = "proxy.obj"

[photographs]
colmap = "cameras"
images = "images"

[[view]]
name = "front"
eye = [2, 0.5, 1.2]
target = [2, 3, 1.2]
size = [32, 24]

[[view]]
name = "left-out"
photograph = "0.png"
leave_out = ["0.png"]
)";
}

void write_mini_scene(const fs::path& folder) {
  write_scan(folder / "s.ply");
  write_proxy(folder / "proxy.obj");
  write_photographs(folder);
  io::write_text(folder / "scene.toml", mini_scene_text());
}

std::vector<std::string> mini_outputs() {
  return {"scans/s/range.exr",
          "scans/s/range.png",
          "scans/s/classes.png",
          "scans/s/labels.exr",
          "scans/s/planes.json",
          "scans/s/intersections.obj",
          "scans/s/intersections.png",
          "scans/s/planes/0001.png",
          "scans/s/planes/0002.png",
          "scans/s/planes/0003.png",
          "scans/s/planes/0004.png",
          "scans/s/planes/0005.png",
          "scans/s/planes/0006.png",
          "scans/s/planes/index.json",
          "scans/s/detail.ply",
          "scans/s/colour.exr",
          "scans/s/pose.json",
          "scans/s/residuals.png",
          "views/front.exr",
          "views/front.png",
          "views/left-out.exr",
          "views/left-out.png",
          "views/left-out-pair.png",
          "report/registration-before.png",
          "report/registration-after.png",
          "report/pictures/scans/s/range.jpg",
          "report/pictures/scans/s/classes.jpg",
          "report/pictures/scans/s/residuals.jpg",
          "report/pictures/scans/s/intersections.jpg",
          "report/pictures/views/front.jpg",
          "report/pictures/views/left-out.jpg",
          "report/pictures/views/left-out-pair.jpg",
          "report/pictures/report/registration-before.jpg",
          "report/pictures/report/registration-after.jpg",
          "report/index.html",
          "report/timing.js",
          "timing.json",
          "summary.json"};
}

fs::path mini_scene() {
  return fs::path(HYBRID_E2E_DIR) / "mini-scene";
}

fs::path mini_result() {
  return fs::path(HYBRID_E2E_DIR) / "mini-result";
}

// Not a test of its own: ctest runs it before all others.
TEST(Fixture, DISABLED_make_mini_scene) {
  fs::remove_all(mini_scene());
  fs::remove_all(mini_result());
  write_mini_scene(mini_scene());
  const auto outcome = run("hybrid run " + (mini_scene() / "scene.toml").string() + " --quiet --out " +
                           mini_result().string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

}  // namespace hybrid::e2e
