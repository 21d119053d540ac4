// hybrid run --only export on the tiny room: every file is listed, none else is there, and readers of their
// own find in them what the run says.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "io/cameras/colmap.hpp"
#include "io/cameras/write_colmap.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "io/read_scan.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string export_room(const fs::path& out, const std::string& more = "") {
  const auto outcome =
      run("hybrid run " + (room() / "scene.toml").string() + " --only export --quiet --out " + out.string() +
          " --set export.texel_m=0.02 --set export.atlas_page=1024 " + more);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.err;
}

std::set<std::string> files_below(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), folder).generic_string());
  return files;
}

std::set<std::string> listed(const Json& index) {
  std::set<std::string> files = {"index.json"};
  for (const auto& row : index.at("files")) files.insert(row.at("file").get<std::string>());
  return files;
}

Eigen::AlignedBox3d box_of(const Scan& scan, const Pose& pose) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (const Vec3 point = scan.point(i); point.allFinite()) box.extend(pose * point);
  return box;
}

}  // namespace

TEST(Export, every_file_is_listed_read_again_and_the_same_in_a_second_run) {
  const Scratch scratch;
  export_room(scratch / "a");
  const fs::path folder = scratch / "a" / "export";
  const Json index = Json::parse(io::read_text(folder / "index.json"));
  const auto files = files_below(folder);
  EXPECT_EQ(files, listed(index));
  for (const char* name :
       {"scene.glb", "scene.obj", "scene.mtl", "atlas-0.png", "coverage-0.png", "points.ply", "points.las",
        "scans.e57", "colmap/images.txt", "scene.rib", "world.rib"})
    EXPECT_TRUE(files.count(name)) << name;
  EXPECT_FALSE(fs::exists(scratch / "a" / "views"));
  const Json summary = Json::parse(io::read_text(scratch / "a" / "summary.json"));
  EXPECT_EQ(summary.at("export"), index);

  const std::size_t count = index.at("points").at("count");
  const Scan ply = io::read_scan(folder / "points.ply", 0), las = io::read_scan(folder / "points.las", 0);
  ASSERT_EQ(ply.points.size(), count);
  ASSERT_EQ(las.points.size(), count);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) worst = std::max(worst, (ply.point(i) - las.point(i)).norm());
  EXPECT_LT(worst, 2e-5);  // LAS has steps of 0.01 mm
  EXPECT_EQ(ply.rgb, las.rgb);
  const PolygonModel proxy = io::read_obj(room() / "proxy.obj");
  Eigen::AlignedBox3d model;
  for (const Vec3& vertex : proxy.vertices) model.extend(vertex);
  const Eigen::AlignedBox3d cloud = box_of(ply, Pose());
  EXPECT_LT((cloud.min() - model.min()).norm(), 0.6);  // the room, with its recesses
  EXPECT_LT((cloud.max() - model.max()).norm(), 0.6);

  // Registered scans: their poses take the samples into the same box.
  const auto scans = io::list_scans(folder / "scans.e57");
  ASSERT_EQ(scans.size(), 2u);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Scan scan = io::read_scan(folder / "scans.e57", i);
    ASSERT_TRUE(scan.world_from_scan.has_value());
    const auto box = box_of(scan, *scan.world_from_scan);
    EXPECT_LT((box.min() - model.min()).norm(), 0.6) << i;
    EXPECT_LT((box.max() - model.max()).norm(), 0.6) << i;
  }
  EXPECT_GE(io::read_obj(folder / "scene.obj").faces.size(), proxy.faces.size());
  EXPECT_EQ(io::read_colmap(folder / "colmap").photographs.size(), 6u);
  const auto size = io::picture_size(folder / "atlas-0.png");
  EXPECT_EQ(size.width, index.at("atlas").at("pages")[0][0].get<int>());

  export_room(scratch / "b", "--threads 1 --tile 200 --set render.tile=100");
  EXPECT_EQ(io::read_text(scratch / "b" / "export" / "index.json"), io::read_text(folder / "index.json"));
  for (const auto& name : files)
    EXPECT_EQ(io::fingerprint(scratch / "b" / "export" / name).xxh3, io::fingerprint(folder / name).xxh3)
        << name;
}

TEST(Export, a_smaller_one_removes_what_the_larger_one_left_and_nothing_else) {
  const Scratch scratch;
  export_room(scratch / "a", "--set 'export.formats=colmap, st' ");
  io::write_text(scratch / "a/export/notes.txt", "mine");
  const std::string said = export_room(scratch / "a", "--set export.formats=ply");
  EXPECT_EQ(files_below(scratch / "a/export"),
            (std::set<std::string>{"index.json", "notes.txt", "points.ply"}));
}

TEST(Export, coordinates_get_the_shift_and_the_crs_back) {
  const Scratch scratch;
  std::string scene = io::read_text(room() / "scene.toml");
  const std::string head = "[scene]\n";
  scene.replace(scene.find(head), head.size(),
                head + "crs = \"EPSG:27700\"\nshift = [530000.0, 180000.0, 12.5]\n");
  fs::copy(room(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene" / "scene.toml", scene);
  const auto outcome =
      run("hybrid run " + (scratch / "scene/scene.toml").string() + " --only export --quiet --out " +
          (scratch / "out").string() + " --set 'export.formats=ply las e57'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  export_room(scratch / "plain", "--set export.formats=ply");
  const Scan plain = io::read_scan(scratch / "plain/export/points.ply", 0);
  for (const char* name : {"points.ply", "points.las"}) {
    const Scan shifted = io::read_scan(scratch / "out/export" / name, 0);
    ASSERT_EQ(shifted.points.size(), plain.points.size());
    for (std::size_t i = 0; i < plain.points.size(); i += 97)
      EXPECT_LT((shifted.point(i) - plain.point(i) - Vec3(530000, 180000, 12.5)).norm(), 4e-5);
  }
  EXPECT_TRUE(run("hybrid info " + (scratch / "out/export/points.las").string()).out.find("27700") !=
              std::string::npos);
  const Scan scan = io::read_scan(scratch / "out/export/scans.e57", 0);
  EXPECT_GT(scan.world_from_scan->translation.x(), 529000);
}

// Survey's coordinates everywhere, as programs for maps export them.
TEST(Export, a_scene_in_the_coordinates_of_the_map_comes_out_in_them_as_a_local_one_does) {
  const Scratch scratch;
  const Vec3 shift(530000, 180000, 12.5);
  const auto write = [&](const fs::path& folder, bool on_map) {
    fs::copy(room(), folder, fs::copy_options::recursive);
    std::string scene = io::read_text(room() / "scene.toml");
    scene.insert(scene.find("[scene]\n") + 8, "shift = [530000.0, 180000.0, 12.5]\n");
    for (const std::string key : {" model = [", "eye = [", "target = ["})
      for (std::size_t at = 0; on_map && (at = scene.find(key, at)) != std::string::npos; at += key.size()) {
        Vec3 point;
        char comma = 0;
        std::istringstream(scene.substr(at + key.size())) >> point.x() >> comma >> point.y() >> comma >>
            point.z();
        point += shift;
        scene.replace(at, scene.find(']', at) + 1 - at,
                      fmt::format("{}{}, {}, {}]", key, point.x(), point.y(), point.z()));
      }
    io::write_text(folder / "scene.toml", scene);
    if (!on_map) return;
    PolygonModel model = io::read_obj(folder / "proxy.obj");
    for (Vec3& vertex : model.vertices) vertex += shift;
    io::write_obj(folder / "proxy.obj", model);
    auto cameras = io::read_colmap(folder / "cameras").photographs;
    for (Photograph& camera : cameras)
      camera.cam_from_world.translation -= camera.cam_from_world.rotation * shift;
    io::write_colmap(folder / "cameras", cameras, {});
  };
  for (const bool on_map : {false, true}) {
    const std::string name = on_map ? "map" : "local";
    write(scratch / name, on_map);
    const auto outcome = run("hybrid run " + (scratch / name / "scene.toml").string() +
                             " --only register,render,export --quiet --out " +
                             (scratch / ("out-" + name)).string() + " --set export.formats=ply");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("agreement"), std::string::npos) << outcome.err;
  }
  const Scan local = io::read_scan(scratch / "out-local/export/points.ply", 0),
             map = io::read_scan(scratch / "out-map/export/points.ply", 0);
  EXPECT_GT(map.point(0).x(), 529000);
  ASSERT_EQ(map.points.size(), local.points.size());
  for (std::size_t i = 0; i < map.points.size(); i += 97)
    EXPECT_LT((map.point(i) - local.point(i)).norm(), 1e-4);
  const auto red = [&](const std::string& name) {
    std::vector<double> shares;
    const auto summary = json_of(scratch / name / "summary.json");
    for (const auto& view : summary["views"]) shares.push_back(view.value("red_share", 0.0));
    return shares;
  };
  const auto ours = red("out-local"), theirs = red("out-map");
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_NEAR(ours[i], theirs[i], 0.002);
}

TEST(Export, says_what_cannot_be_exported_and_exports_the_rest) {
  const Scratch scratch;
  // No photographs: plain faces, points, scans.
  std::string scene = io::read_text(room() / "scene.toml");
  const auto from = scene.find("[photographs]"), to = scene.find("[[view]]");
  ASSERT_NE(from, std::string::npos);
  fs::copy(room(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene/scene.toml", scene.substr(0, from) + "[export]\n");
  auto outcome = run("hybrid run " + (scratch / "scene/scene.toml").string() +
                     " --only export --quiet --out " + (scratch / "out").string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  auto files = files_below(scratch / "out/export");
  EXPECT_EQ(files, (std::set<std::string>{"hybrid_blend.sl", "hybrid_projector.sl", "index.json",
                                          "points.las", "points.ply", "scans.e57", "scene.glb", "scene.mtl",
                                          "scene.obj", "scene.rib", "world.rib"}));
  EXPECT_NE(io::read_text(scratch / "out/export/index.json").find("no photographs: no COLMAP model"),
            std::string::npos);
  // No model, so no registered scan: cameras and maps alone.
  const std::string cameras = "[[scan]]\nfile = \"scans/west.ply\"\n" + scene.substr(from, to - from);
  io::write_text(scratch / "scene/cameras.toml", cameras);
  outcome = run("hybrid run " + (scratch / "scene/cameras.toml").string() + " --only export --quiet --out " +
                (scratch / "cameras").string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  files = files_below(scratch / "cameras/export");
  EXPECT_TRUE(files.count("colmap/cameras.txt"));
  EXPECT_TRUE(files.count("scene.glb"));
  EXPECT_FALSE(files.count("scene.rib"));
  EXPECT_NE(outcome.err.find("no faces: no atlas"), std::string::npos);
}

TEST(Export, wrong_keys_are_errors_that_name_them) {
  const Scratch scratch;
  const std::string scene = (room() / "scene.toml").string();
  for (const auto& [set, part] : {std::pair{"export.formats=gltf", "found \"gltf\""},
                                  {"export.formats=", "found nothing"},
                                  {"export.texel=1", "texel"},
                                  {"export.atlas_page=8", "atlas_page"},
                                  {"export.picture=bmp", "picture"}}) {
    const auto outcome = run("hybrid run " + scene + " --only export --out " + (scratch / "x").string() +
                             " --set '" + set + "'");
    EXPECT_EQ(outcome.exit_code, 2) << set;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(scratch / "x"));
}

}  // namespace hybrid::e2e
