// [edit] of the scene file through the program, on the mini scene: replayable, with its files, and gone again
// when the edits go.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bad_mini_scene.hpp"
#include "geometry/face_frame.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "io/ply/ply.hpp"
#include "io/read_scan.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

nlohmann::json summary_of(const fs::path& out) {
  return nlohmann::json::parse(io::read_text(out / "summary.json"));
}

// The mini scene with more in its scene file, run into OUT.
Outcome run_edited(const Scratch& scratch, const std::string& edits, const std::string& options = "") {
  if (!fs::exists(scratch / "scene")) fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene/scene.toml", mini_scene_text() + edits);
  return run("hybrid run " + (scratch / "scene/scene.toml").string() + " --quiet " + options + " --out " +
             (scratch / "out").string());
}

// The mini scene's scan with a second return behind and one before every 9th point: its grid has room for
// one.
void add_colliding_samples(const Scratch& scratch) {
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  const Scan scan = io::read_scan(scratch / "scene/s.ply", 0);
  std::vector<io::PlyPoint> points;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    for (const double factor : {1.0, 1.25, 0.75}) {
      if (factor != 1 && i % 9) continue;
      const Vec3 point = factor * scan.point(i);
      points.push_back({{point.x(), point.y(), point.z()}});
    }
  io::write_ply(scratch / "scene/s.ply", points, {});
}

// How many samples of this file of the scan an edit of 21 x 21 nodes moves away by 7 cm; the others stay.
int moved_by_depth_edit(const Scratch& scratch, const std::string& file) {
  EXPECT_EQ(run_edited(scratch, "", "--only planes").exit_code, 0);
  const auto before = io::read_scan(scratch / ("out/scans/s/" + file), 0);
  const auto moved = run_edited(
      scratch,
      "[[edit.depth]]\nscan = \"s\"\npolygon = [[20, 30], [20, 50], [40, 50], [40, 30]]\nby_m = 0.07\n",
      "--only planes,edit");
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  const auto after = io::read_scan(scratch / ("out/scans/s/" + file), 0);
  EXPECT_EQ(after.points.size(), before.points.size());
  int changed = 0;
  for (std::size_t i = 0; i < std::min(after.points.size(), before.points.size()); ++i) {
    const double by = after.point(i).norm() - before.point(i).norm();
    EXPECT_TRUE(std::abs(by) < 1e-6 || std::abs(by - 0.07) < 1e-5) << by;
    changed += by > 0.01;
  }
  return changed;
}

}  // namespace

TEST(Edit, removes_faces_and_cuts_holes_and_the_same_file_makes_the_same_model) {
  const Scratch scratch;
  const std::string edits =
      "[edit]\nremove_faces = [1]\n[[edit.holes]]\nface = \"face-2\"\n"
      "world = [[1, 0, 0.5], [2, 0, 0.5], [2, 0, 1.5], [1, 0, 1.5]]\n";
  const auto made = run_edited(scratch, edits, "--only edit");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const PolygonModel model = io::read_obj(scratch / "out/model/edited.obj");
  ASSERT_EQ(model.faces.size(), 5u);
  EXPECT_EQ(model.faces[1].name, "face-2");
  EXPECT_NEAR(face_area_m2(model, model.faces[1]), 4 * 2.5 - 1, 1e-6);
  // The hole is outlined where the model is as it became, to the right.
  const auto picture = io::read_photograph(scratch / "out/model/edited.png", 1608, 1208);
  std::array<int, 2> outlined{};
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (picture.at(x, y)[0] == 200 && picture.at(x, y)[1] == 0) ++outlined[2 * x > picture.width];
  EXPECT_EQ(outlined[0], 0);
  EXPECT_GT(outlined[1], 100);
  EXPECT_FALSE(fs::exists(scratch / "out/views"));  // --only edit
  const auto edit = summary_of(scratch / "out")["edit"];
  EXPECT_EQ(edit["removed_faces"], nlohmann::json::array({"face-1"}));
  EXPECT_EQ(edit["holes"][0]["face"], "face-2");
  const std::string before = content_list(scratch / "out");
  ASSERT_EQ(run_edited(scratch, edits, "--only edit --threads 1").exit_code, 0);
  EXPECT_EQ(content_list(scratch / "out"), before);
  // Without the edits their files go.
  ASSERT_EQ(run_edited(scratch, "", "--only edit").exit_code, 0);
  EXPECT_FALSE(fs::exists(scratch / "out/model/edited.obj"));
  EXPECT_FALSE(fs::exists(scratch / "out/model/edited.png"));
}

TEST(Edit, clips_drop_samples_from_what_is_kept_but_not_from_the_range_image) {
  const Scratch scratch;
  ASSERT_EQ(run_edited(scratch, "", "--only planes,register").exit_code, 0);
  const auto plain = io::read_scan(scratch / "out/scans/s/detail.ply", 0);
  // The half of the room with x above 2 m, in the world; the scan's axes are the world's.
  const auto clipped =
      run_edited(scratch, "[[edit.clip]]\nplane = [-1, 0, 0, -2]\n", "--only planes,register,edit");
  ASSERT_EQ(clipped.exit_code, 0) << clipped.err;
  const auto left = io::read_scan(scratch / "out/scans/s/detail.ply", 0);
  EXPECT_LT(left.points.size(), plain.points.size());
  EXPECT_GT(left.points.size(), 0u);
  for (std::size_t i = 0; i < left.points.size(); ++i) EXPECT_LT(left.point(i).x() + 1.6, 2.05);
  EXPECT_EQ(io::read_scan(scratch / "out/scans/s/range.exr", 0).points.size(), 7200u);
  EXPECT_TRUE(fs::exists(scratch / "out/scans/s/clipped.png"));
  EXPECT_GT(summary_of(scratch / "out")["edit"]["scans"]["s"]["clips"][0]["samples"].get<int>(), 1000);
}

TEST(Edit, clipped_samples_beside_the_grid_are_in_no_export_either) {
  const Scratch scratch;
  add_colliding_samples(scratch);
  const std::string half = "[[edit.clip]]\nplane = [-1, 0, 0, -2]\n",
                    options = "--only planes,register,export";
  const std::string clouds = " --set 'export.formats=ply colmap'";
  const auto clipped = run_edited(scratch, half, options + clouds);
  ASSERT_EQ(clipped.exit_code, 0) << clipped.err;
  const auto cloud = io::read_scan(scratch / "out/export/points.ply", 0);
  EXPECT_GT(cloud.points.size(), 0u);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) EXPECT_LT(cloud.point(i).x(), 2.001);
  const auto scan = summary_of(scratch / "out")["scans"][0];
  const int extra = scan["extra_samples"], kept = scan["decimation"]["kept"]["extra"];
  EXPECT_GT(extra, 1000);
  EXPECT_LT(kept, extra - 300);
  EXPECT_GT(kept, 300);
  EXPECT_EQ(io::read_scan(scratch / "out/scans/s/extra.ply", 0).points.size(),
            static_cast<std::size_t>(extra));
  std::int64_t counted = scan["decimation"]["discarded"];
  for (const auto& count : scan["decimation"]["kept"]) counted += count.get<int>();
  EXPECT_EQ(scan["decimation"]["measured"], counted);
  // Nothing is left: nothing is exported.
  const std::string all = "[[edit.clip]]\nbox = [-100, -100, -100, 100, 100, 100]\n";
  ASSERT_EQ(run_edited(scratch, all, options + clouds).exit_code, 0);
  EXPECT_EQ(summary_of(scratch / "out")["export"]["points"]["count"], 0);
  EXPECT_FALSE(fs::exists(scratch / "out/export/points.ply"));
}

TEST(Edit, a_depth_edit_moves_its_area_of_the_range_image) {
  const Scratch scratch;
  EXPECT_EQ(moved_by_depth_edit(scratch, "range.exr"), 21 * 21);
  EXPECT_TRUE(fs::exists(scratch / "out/scans/s/depth-edits.png"));
}

TEST(Edit, a_depth_edit_moves_the_samples_beside_the_grid_too) {
  const Scratch scratch;
  add_colliding_samples(scratch);
  const int moved = moved_by_depth_edit(scratch, "extra.ply");
  EXPECT_NEAR(moved, 2 * 21 * 21 / 9.0, 10);
  EXPECT_EQ(summary_of(scratch / "out")["edit"]["scans"]["s"]["depth_edited_samples"], 21 * 21 + moved);
}

TEST(Edit, clips_that_leave_nothing_of_a_scan_are_told) {
  const Scratch scratch;
  const auto outcome =
      run_edited(scratch, "[[edit.clip]]\nkeep = \"inside\"\nbox = [100, 100, 100, 101, 101, 101]\n",
                 "--only planes,register,edit");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("drop all of its samples"), std::string::npos) << outcome.err;
  EXPECT_NE(summary_of(scratch / "out")["scans"][0]["notes"].dump().find("drop all of its samples"),
            std::string::npos);
}

TEST(Edit, a_clip_that_drops_nothing_is_named) {
  const Scratch scratch;
  const auto outcome = run_edited(scratch,
                                  "[[edit.clip]]\nbox = [100, 100, 100, 101, 101, 101]\n"
                                  "[[edit.clip]]\nplane = [-1, 0, 0, -2]\n",
                                  "--only edit");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("[edit]: clip 1: it drops no sample"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("[edit]: clip 2"), std::string::npos) << outcome.err;
}

TEST(Edit, says_what_no_photograph_sees_and_where_to_stand) {
  const auto summary = summary_of(mini_result());
  const auto& coverage = summary["coverage"];
  EXPECT_NEAR(coverage["area_m2"].get<double>(), 2 * (12 + 10 + 7.5), 1e-6);
  double unseen = 0;
  for (const auto& face : coverage["faces"]) unseen += face["unseen_m2"].get<double>();
  EXPECT_NEAR(coverage["unseen_m2"].get<double>(), unseen, 1e-9);
  EXPECT_GT(unseen, 5);  // both photographs look the same way
  EXPECT_LT(unseen, 55);
  ASSERT_GE(coverage["next_cameras"].size(), 2u);
  double gained = 0, last = 1e9;
  for (const auto& camera : coverage["next_cameras"]) {
    const auto at = camera["position"].get<std::vector<double>>();  // in the room, 30 cm off everything
    const double room_m[3] = {4, 3, 2.5};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GT(at[k], 0.25);
      EXPECT_LT(at[k], room_m[k] - 0.25);
    }
    const double gain = camera["gained_m2"];
    EXPECT_LE(gain, last);
    last = gain;
    gained += gain;
  }
  EXPECT_LE(gained, unseen + 1e-6);
  EXPECT_GT(gained, 0.5 * unseen) << gained << " of " << unseen;
}

}  // namespace hybrid::e2e
