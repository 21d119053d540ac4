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

// Of the corners that the README lists with their picks by eye (there the first pixel's centre is 0.5, 0.5),
// and where all that the proxy was drawn from has them; the README's frame is of edges and points, too.
TEST(LundDoor, corners_picked_by_eye_place_the_cameras) {
  if (!lund_present()) GTEST_SKIP() << "no photographs at " << lund_data() << "; set HYBRID_DATA";
  const Scratch scratch;
  write_small_scene(scratch / "small.toml");
  std::string text = io::read_text(scratch / "small.toml");
  const auto begin = text.find("world_from_photographs = ["), end = text.find("]\n", begin);
  text.replace(begin, end + 2 - begin, R"(landmarks = [
  { photograph = "DSC_0001.JPG", pixel = [1803.3, 1195.8], model = [4.648, -1.116, -0.017], snap = false },
  { photograph = "DSC_0002.JPG", pixel = [1798.3, 1224.9], model = [4.648, -1.116, -0.017], snap = false },
  { photograph = "DSC_0004.JPG", pixel = [1741.8, 1234.2], model = [4.648, -1.116, -0.017], snap = false },
  { photograph = "DSC_0002.JPG", pixel = [1621.8, 387.5], model = [-2.428, 1.406, 0.636], snap = false },
  { photograph = "DSC_0005.JPG", pixel = [1659.8, 322.4], model = [-2.428, 1.406, 0.636], snap = false },
  { photograph = "DSC_0009.JPG", pixel = [1719.8, 299.0], model = [-2.428, 1.406, 0.636], snap = false },
  { photograph = "DSC_0001.JPG", pixel = [878.1, 615.3], model = [-1.166, 3.284, 7.399], snap = false },
  { photograph = "DSC_0004.JPG", pixel = [806.5, 521.4], model = [-1.166, 3.284, 7.399], snap = false },
  { photograph = "DSC_0007.JPG", pixel = [861.6, 487.0], model = [-1.166, 3.284, 7.399], snap = false },
  { photograph = "DSC_0006.JPG", pixel = [38.8, 1232.4], model = [4.720, -0.524, 13.297], snap = false },
  { photograph = "DSC_0008.JPG", pixel = [80.3, 1251.8], model = [4.720, -0.524, 13.297], snap = false },
  { photograph = "DSC_0012.JPG", pixel = [154.1, 1215.6], model = [4.720, -0.524, 13.297], snap = false },
]
)");
  io::write_text(scratch / "small.toml", text);
  const auto outcome = run("hybrid render " + (scratch / "small.toml").string() + " --out " +
                           (scratch / "out").string() + " --quiet --view front");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(outcome.err.empty()) << outcome.err;
  const auto found = json_of(scratch / "out/summary.json");
  const auto& landmarks = found["photograph_landmarks"];
  for (const auto& pick : landmarks["picks"]) EXPECT_LT(pick["residual_px"].get<double>(), 2) << pick;
  const Pose pose = pose_from_row_major(landmarks["world_from_photographs"].get<std::array<double, 16>>());
  const Pose documented =
      pose_from_row_major(*io::read_scene_file(kLundDoor).photographs->world_from_photographs);
  for (const Vec3& point : {Vec3(-4, 0, 0), Vec3(4, 0, 12), Vec3(0, 4, 4), Vec3(0, -16, 3)}) {
    const Vec3 there = pose * (documented.inverse() * point);
    EXPECT_LT((there - point).norm(), 0.001 * kFacadeWidth) << point.transpose();
  }
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
