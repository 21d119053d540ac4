// hybrid register --write: every sample of a scan in the world, read again with the readers of scans.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "io/read_scan.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

const Vec3 kShift(530000, 180000, 12.5);

std::vector<std::size_t> returns_of(const Scan& scan) {
  std::vector<std::size_t> returns;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (scan.point(i).allFinite()) returns.push_back(i);
  return returns;
}

Pose pose_of(const fs::path& scan_folder) {
  const Json json = Json::parse(io::read_text(scan_folder / "pose.json"));
  return pose_from_row_major(json.at("world_from_scan").get<std::array<double, 16>>());
}

// Farthest that a sample of the file is from where the pose, and the shift, bring the source's.
double farthest(const fs::path& file, const Scan& source, const Pose& pose, const Vec3& shift) {
  const Scan moved = io::read_scan(file, 0);
  const auto from = returns_of(source), to = returns_of(moved);
  EXPECT_EQ(from.size(), to.size()) << file;
  if (from.size() != to.size() || from.empty()) return INFINITY;
  EXPECT_FALSE(moved.world_from_scan.has_value());
  double worst = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 expected = pose * source.point(from[i]) + shift;
    worst = std::max(worst, (moved.point(to[i]) - expected).cwiseAbs().maxCoeff());
    if (!source.rgb.empty()) {
      EXPECT_EQ(moved.rgb[to[i]], source.rgb[from[i]]);
    }
  }
  return worst;
}

fs::path register_room(const Scratch& scratch, const std::string& name, const std::string& head,
                       const std::string& more) {
  std::string scene = io::read_text(room() / "scene.toml");
  const std::string section = "[scene]\n";
  scene.replace(scene.find(section), section.size(), section + head);
  if (!fs::exists(scratch / "scene")) fs::copy(room(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene" / "scene.toml", scene);
  const auto outcome = run("hybrid register " + (scratch / "scene/scene.toml").string() + " --quiet --out " +
                           (scratch / name).string() + more);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return scratch / name / "scans" / "west";
}

}  // namespace

TEST(RegisteredScans, ply_and_las_have_the_pose_in_their_samples_and_e57_beside_them) {
  const Scratch scratch;
  const fs::path west = register_room(scratch, "out", "", " --write ply,las,e57");
  const Scan source = io::read_scan(room() / "scans/west.ply", 0);
  const Pose pose = pose_of(west);
  EXPECT_GT(pose.translation.norm() + pose.rotation.vec().norm(), 0.1);  // else the test says nothing
  EXPECT_LT(farthest(west / "registered.ply", source, pose, Vec3::Zero()), 2e-6);
  EXPECT_LT(farthest(west / "registered.las", source, pose, Vec3::Zero()), 0.6e-5 + 2e-6);
  const Scan e57 = io::read_scan(west / "registered.e57", 0);
  EXPECT_EQ(io::list_scans(west / "registered.e57").size(), 1u);
  EXPECT_NE(io::read_text(west / "registered.e57").find(">west</name>"), std::string::npos);
  ASSERT_TRUE(e57.world_from_scan);
  EXPECT_LT((e57.world_from_scan->translation - pose.translation).norm(), 1e-12);
  EXPECT_LT(e57.world_from_scan->rotation.angularDistance(pose.rotation), 1e-12);
  const auto from = returns_of(source), to = returns_of(e57);
  ASSERT_EQ(from.size(), to.size());
  for (std::size_t i = 0; i < from.size(); ++i) ASSERT_EQ(e57.point(to[i]), source.point(from[i])) << i;

  const Json summary = Json::parse(io::read_text(scratch / "out/summary.json"));
  const Json written = summary.at("scans").at(0).at("registration").at("written");
  ASSERT_EQ(written.size(), 3u);
  for (const Json& row : written) {
    EXPECT_EQ(row.at("bytes"), fs::file_size(west / row.at("file").get<std::string>()));
    EXPECT_EQ(row.at("samples"), from.size());
  }

  // Not asked for any more, they are not left beside another pose.
  register_room(scratch, "out", "", "");
  EXPECT_TRUE(fs::exists(west / "pose.json"));
  for (const char* name : {"registered.ply", "registered.las", "registered.e57"})
    EXPECT_FALSE(fs::exists(west / name)) << name;
}

TEST(RegisteredScans, far_from_the_origin_nothing_is_lost_and_the_coordinate_system_is_named) {
  const Scratch scratch;
  const fs::path west =
      register_room(scratch, "out", "crs = \"EPSG:27700\"\nshift = [530000.0, 180000.0, 12.5]\n",
                    " --set 'register.write=ply las e57'");
  const Scan source = io::read_scan(room() / "scans/west.ply", 0);
  const Pose pose = pose_of(west);
  EXPECT_LT(farthest(west / "registered.ply", source, pose, kShift), 2e-6);
  EXPECT_LT(farthest(west / "registered.las", source, pose, kShift), 0.6e-5 + 2e-6);
  const Scan e57 = io::read_scan(west / "registered.e57", 0);
  EXPECT_LT((e57.world_from_scan->translation - pose.translation - kShift).norm(), 1e-9);
  for (const char* name : {"registered.las", "registered.e57"})
    EXPECT_NE(io::list_scans(west / name)[0].crs.find("27700"), std::string::npos) << name;
}

TEST(RegisteredScans, a_format_that_is_none_is_named_before_anything_is_read) {
  const Scratch scratch;
  const auto outcome = run("hybrid register " + (room() / "scene.toml").string() + " --write ply,laz --out " +
                           (scratch / "out").string());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("e57, las, pcd, ply, pts, ptx"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("laz"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

}  // namespace hybrid::e2e
