// Real photographs with known cameras on the proxy drawn from their triangulated points (skipped where the
// data are absent).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "io/scene/scene_file.hpp"
#include "places.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

namespace fs = std::filesystem;

constexpr double kFacadeWidth = 8.817;  // of the portal's front, left edge to right edge, in the model's unit
const fs::path kLundDoor = fs::path(HYBRID_PROJECT_DIR) / "datasets/lund-door/scene.toml";

fs::path lund_data() {
  const char* folder = std::getenv("HYBRID_DATA");
  return folder ? fs::path(folder) : fs::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data";
}

bool lund_present() {
  return fs::exists(lund_data() / "photos/lund-door/colmap_ground_truth/points3D.txt");
}

// The positions of COLMAP's points3D.txt: id x y z r g b error track...
std::vector<Vec3> colmap_points(const fs::path& file) {
  std::vector<Vec3> points;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    std::uint64_t id = 0;
    Vec3 point;
    words >> id >> point.x() >> point.y() >> point.z();
    points.push_back(point);
  }
  return points;
}

Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  return a + std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0) * (b - a);
}

double distance_to_face(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const bool inside = (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 &&
                      (a - c).cross(p - c).dot(normal) >= 0;
  if (inside) return std::abs((p - a).dot(normal)) / normal.norm();
  return std::min({(p - nearest_on_segment(p, a, b)).norm(), (p - nearest_on_segment(p, b, c)).norm(),
                   (p - nearest_on_segment(p, c, a)).norm()});
}

double distance_to_proxy(const Vec3& p, const PolygonModel& model, const std::vector<Triangle>& triangles,
                         const std::vector<Eigen::AlignedBox3d>& boxes) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (boxes[t].exteriorDistance(p) >= nearest) continue;
    const auto& v = triangles[t].vertices;
    nearest = std::min(nearest,
                       distance_to_face(p, model.vertices[v[0]], model.vertices[v[1]], model.vertices[v[2]]));
  }
  return nearest;
}

// The scene with pictures of a tenth of the size, its files named absolutely.
void write_small_scene(const fs::path& file) {
  std::string text = io::read_text(kLundDoor);
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  };
  replace("\"proxy.obj\"", fmt::format("\"{}\"", (kLundDoor.parent_path() / "proxy.obj").string()));
  replace("${HYBRID_DATA:-../../../shared/data}", fs::absolute(lund_data()).string());
  replace("[900, 1200]", "[90, 120]");
  replace("[1280, 900]", "[128, 90]");
  // The dual blend's low bands of twelve photographs take most of a run's time; other tests have them.
  io::write_text(file, text + "\n[render]\nblend = \"nearest\"\n");
}

}  // namespace

// The README's last line of residuals: 11,384 points, 95.7 % within 1 % of the facade's width, median 0.014.
TEST(LundDoor, triangulated_points_lie_on_the_proxy) {
  if (!lund_present()) GTEST_SKIP() << "no photographs at " << lund_data() << "; set HYBRID_DATA";
  const auto scene = io::read_scene_file(kLundDoor);
  const PolygonModel model = io::read_obj(scene.model->file);
  const auto triangles = triangulate(model);
  std::vector<Eigen::AlignedBox3d> boxes(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t vertex : triangles[t].vertices) boxes[t].extend(model.vertices[vertex]);

  const Pose world_from_photographs = pose_from_row_major(*scene.photographs->world_from_photographs);
  std::vector<double> distances;
  for (const Vec3& point : colmap_points(scene.photographs->cameras.path / "points3D.txt"))
    distances.push_back(distance_to_proxy(world_from_photographs * point, model, triangles, boxes));
  ASSERT_EQ(distances.size(), 11384u);
  std::sort(distances.begin(), distances.end());
  const auto within = std::lower_bound(distances.begin(), distances.end(), 0.01 * kFacadeWidth);
  EXPECT_GT(static_cast<double>(within - distances.begin()) / 11384, 0.955);
  EXPECT_LT(distances[distances.size() / 2], 0.015);
}

TEST(LundDoor, a_scene_of_photographs_without_scans_runs) {
  if (!lund_present()) GTEST_SKIP() << "no photographs at " << lund_data() << "; set HYBRID_DATA";
  const Scratch scratch;
  write_small_scene(scratch / "small.toml");
  const auto outcome =
      run("hybrid run " + (scratch / "small.toml").string() + " --quiet --out " + (scratch / "out").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  const auto summary = nlohmann::json::parse(io::read_text(scratch / "out/summary.json"));
  EXPECT_TRUE(summary["scans"].empty());
  EXPECT_TRUE(summary["failures"].empty());
  ASSERT_EQ(summary["views"].size(), 6u);
  for (const auto& view : summary["views"]) {
    const std::string name = view["name"];
    if (name == "front" || name == "left" || name == "right") {
      EXPECT_GT(view["surface_share"], 0.98) << name;
      EXPECT_LT(view["red_share"], 0.05) << name;
    }
    if (name == "without-DSC_0006") {
      EXPECT_GT(view["left_out"]["psnr_db"], 31.0);
      EXPECT_GT(view["left_out"]["ssim"], 0.92);
      EXPECT_GT(view["left_out"]["share_seen"], 0.99);
    }
  }
}

}  // namespace hybrid::e2e
