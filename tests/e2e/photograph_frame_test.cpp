// Photographs whose cameras are in another frame than the model, as structure from motion gives them: the run
// says so, and landmarks in the photographs place them. And photographs of which one is damaged.
#include <gtest/gtest.h>

#include "geometry/camera.hpp"
#include "io/cameras/colmap.hpp"
#include "io/cameras/write_colmap.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

class PhotographFrame : public ::testing::Test {
 protected:
  PhotographFrame() {
    fs::copy(room(), scratch_ / "room", fs::copy_options::recursive);
    cameras_ = io::read_colmap(folder() / "cameras").photographs;
  }

  fs::path folder() const { return scratch_ / "room"; }
  fs::path out() const { return scratch_ / "out"; }

  // Every camera, and the model beside them, as if the reconstruction lay elsewhere, in units of 4 m.
  void move_cameras() {
    std::vector<Photograph> moved = cameras_;
    for (Photograph& photograph : moved) {
      Pose frame_from_cam = frame_ * photograph.cam_from_world.inverse();
      frame_from_cam.scale = 1;
      photograph.cam_from_world = frame_from_cam.inverse();
    }
    fs::remove_all(folder() / "cameras");
    fs::create_directories(folder() / "cameras");
    ASSERT_TRUE(io::write_colmap(folder() / "cameras", moved, {}).empty());
  }

  // Tenths of pixels of the model's corners in every photograph, behind walls, too.
  std::string landmarks() const {
    const PolygonModel model = io::read_obj(folder() / "proxy.obj");
    std::string text = "landmarks = [\n";
    for (const Photograph& photograph : cameras_)
      for (std::size_t vertex = 0; vertex < model.vertices.size(); ++vertex)
        if (const auto at = photograph.camera.project(photograph.cam_from_world * model.vertices[vertex]))
          text += fmt::format("  {{ photograph = \"{}\", pixel = [{:.1f}, {:.1f}], vertex = {} }},\n",
                              photograph.name, at->y() - 0.5, at->x() - 0.5, vertex);
    return text + "]\n";
  }

  void add_to_photographs(const std::string& text) const {
    const std::string key = "images = \"photographs\"\n";
    std::string scene = io::read_text(folder() / "scene.toml");
    scene.insert(scene.find(key) + key.size(), text);
    io::write_text(folder() / "scene.toml", scene);
  }

  Outcome render(const std::string& more = "") const {
    return hybrid::e2e::run("hybrid render " + (folder() / "scene.toml").string() + " --out " +
                            out().string() + " --quiet --force --view proxy-textured " + more);
  }

  const Scratch scratch_;
  const Pose frame_{0.25, Eigen::Quaterniond(Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized())), {4, -3, 20}};
  std::vector<Photograph> cameras_;
};

}  // namespace

TEST_F(PhotographFrame, another_frame_is_told_and_landmarks_place_it) {
  const Outcome right = render();
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_EQ(right.err.find("warning"), std::string::npos) << right.err;

  move_cameras();
  const Outcome moved = render();
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_NE(moved.err.find("give [photographs] landmarks, or world_from_photographs"), std::string::npos)
      << moved.err;

  EXPECT_FALSE(json_of(out() / "summary.json")["warnings"].empty());

  add_to_photographs(landmarks());
  const Outcome placed = render();
  EXPECT_EQ(placed.exit_code, 0) << placed.err;
  EXPECT_EQ(placed.err.find("warning"), std::string::npos) << placed.err;
  const Json summary = json_of(out() / "summary.json");
  EXPECT_FALSE(summary.contains("warnings")) << summary["warnings"];
  const Json& found = summary["photograph_landmarks"];
  const Pose pose = pose_from_row_major(found["world_from_photographs"].get<std::array<double, 16>>());
  // A pixel is 65 mm at the corners, a tenth of one what picks are rounded to.
  for (const Photograph& camera : cameras_)
    EXPECT_LT((pose * (frame_ * camera.centre()) - camera.centre()).norm(), 0.01) << camera.name;
  EXPECT_NEAR(found["scale"].get<double>(), 4, 0.005);
  EXPECT_LT(found["rms_m"].get<double>(), 0.01);
  for (const auto& pick : found["picks"]) EXPECT_LT(pick["residual_px"].get<double>(), 0.2) << pick;
  for (const auto& row : summary["equalisation"]) EXPECT_GT(row["agreement"].get<double>(), 0.7) << row;
}

TEST_F(PhotographFrame, a_pick_that_names_nothing_is_told_with_its_line_before_anything_runs) {
  add_to_photographs("landmarks = [\n{ photograph = \"00.jpg\", pixel = [1, 1], vertex = 0 }]\n");
  for (const std::string more : {"", "--dry-run"}) {
    const Outcome outcome = render(more);
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_NE(outcome.err.find("landmark 1 (line "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("did you mean '00"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(out()));
  }
}

TEST_F(PhotographFrame, with_salvage_a_damaged_and_a_missing_photograph_are_left_out) {
  const fs::path damaged = folder() / "photographs/001.jpg";
  fs::resize_file(damaged, fs::file_size(damaged) / 2);
  const Outcome strict = render();
  EXPECT_EQ(strict.exit_code, 4);
  EXPECT_NE(strict.err.find("001.jpg: is cut short"), std::string::npos) << strict.err;
  EXPECT_NE(strict.err.find("--salvage"), std::string::npos) << strict.err;

  fs::rename(folder() / "photographs/000.jpg", folder() / "photographs/000.JPG");
  const Outcome missing = render();
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_NE(missing.err.find("000.JPG is there"), std::string::npos) << missing.err;

  const Outcome tried = render("--salvage --dry-run");
  EXPECT_EQ(tried.exit_code, 0) << tried.err;
  EXPECT_NE(tried.out.find("photograph 000.jpg is left out"), std::string::npos) << tried.out;

  const Outcome salvaged = render("--salvage");
  EXPECT_EQ(salvaged.exit_code, 0) << salvaged.err;
  for (const char* name : {"photograph 000.jpg is left out: ", "photograph 001.jpg is left out: "})
    EXPECT_NE(salvaged.err.find(name), std::string::npos) << salvaged.err;
  const Json summary = json_of(out() / "summary.json");
  ASSERT_EQ(summary["equalisation"].size(), cameras_.size() - 2);
  EXPECT_EQ(summary["equalisation"][0]["photograph"], cameras_[2].name);
}

TEST_F(PhotographFrame, a_textured_view_without_photographs_is_told) {
  std::string scene = io::read_text(folder() / "scene.toml");
  const auto begin = scene.find("[photographs]");
  scene.erase(begin, scene.find("[[view]]") - begin);
  io::write_text(folder() / "scene.toml", scene);
  const Outcome outcome = render();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("1 textured view has no photographs and is all red (proxy-textured)"),
            std::string::npos)
      << outcome.err;
}

TEST_F(PhotographFrame, the_folder_above_a_colmap_model_is_told) {
  fs::create_directories(folder() / "sparse");
  fs::rename(folder() / "cameras", folder() / "sparse/0");
  std::string scene = io::read_text(folder() / "scene.toml");
  const std::string key = "colmap = \"cameras\"";
  scene.replace(scene.find(key), key.size(), "colmap = \"sparse\"");
  io::write_text(folder() / "scene.toml", scene);
  const Outcome outcome = render();
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_NE(outcome.err.find("one is in " + (folder() / "sparse/0").string()), std::string::npos)
      << outcome.err;
}

}  // namespace hybrid::e2e
