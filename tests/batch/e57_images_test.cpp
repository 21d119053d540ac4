#include "batch/photographs/e57_images.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "io/files.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"

namespace hybrid::testing::e57_images_test {
namespace {

Pose pose(double yaw, const Vec3& translation, double scale = 1) {
  return {scale, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), translation};
}

}  // namespace

// Two scans of one file whose registered poses disagree with the file's, and each other, by a little.
TEST(PlaceCamera, goes_with_its_scan_else_with_the_file_else_with_the_files_frame) {
  const std::vector<batch::E57Frame> frames = {{"a.e57", {pose(0.3, {1, 2, 3}), pose(-1, {4, 0, 1})}},
                                               {"b.e57", {}}};
  const Pose world_from_file = pose(2, {-5, 7, 0.5});
  const std::vector<batch::PlacedScan> scans = {
      {"a.e57", 0, "first", pose(0.01, {0, 0, 0.1}) * world_from_file * frames[0].file_from_scan[0]},
      {"a.e57", 1, "second", world_from_file * frames[0].file_from_scan[1]}};
  const Pose file_from_cam = pose(0.7, {1, 1, 1});

  const auto second = batch::place_camera({"a.e57", 1, file_from_cam}, frames, scans);
  EXPECT_EQ(second.with, "scan second");
  EXPECT_LT(difference(second.cam_from_world.inverse(), world_from_file * file_from_cam).distance_m, 1e-12);
  // The camera's place as its scanner sees it is what the file says.
  const Vec3 from_scanner =
      scans[0].world_from_scan.inverse() *
      batch::place_camera({"a.e57", 0, file_from_cam}, frames, scans).cam_from_world.inverse().translation;
  EXPECT_LT((from_scanner - frames[0].file_from_scan[0].inverse() * file_from_cam.translation).norm(), 1e-12);

  const auto any = batch::place_camera({"a.e57", {}, file_from_cam}, frames, scans);
  EXPECT_EQ(any.with, "scan first");
  const auto unregistered = batch::place_camera({"a.e57", 0, file_from_cam}, frames, {scans[1]});
  EXPECT_EQ(unregistered.with, "scan second");
  const auto alone = batch::place_camera({"b.e57", {}, file_from_cam}, frames, scans);
  EXPECT_EQ(alone.with, "file frame");
  EXPECT_LT(difference(alone.cam_from_world.inverse(), file_from_cam).distance_m, 1e-12);
}

TEST(PlaceCamera, a_scaled_world_moves_the_centre_and_leaves_the_camera_rigid) {
  const std::vector<batch::E57Frame> frames = {{"a.e57", {Pose()}}};
  const auto placed = batch::place_camera({"a.e57", 0, pose(0, {1, 2, 3})}, frames,
                                          {{"a.e57", 0, "s", pose(0, {1, 0, 0}, 2)}});
  EXPECT_EQ(placed.cam_from_world.scale, 1);
  EXPECT_LT((placed.cam_from_world.inverse().translation - Vec3(3, 4, 6)).norm(), 1e-12);
}

// A real file with one JPEG that has no camera.
TEST(WriteReferences, takes_a_visual_reference_out_as_it_is) {
  const auto file = real_data("scans/e57-pye57/pumpAVisualReferenceImage.e57");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  const TemporaryFolder folder;
  batch::write_references(folder.path(), file, 0, false);
  const std::string bytes = io::read_text(folder.path() / "reference-pumpVisual.jpg");
  EXPECT_EQ(bytes.size(), 1504576u);
  EXPECT_EQ(bytes.substr(0, 3), "\xff\xd8\xff");
  const io::PictureSize size = io::picture_size(folder.path() / "reference-pumpVisual.jpg");
  EXPECT_EQ(size.width, 3072);
  EXPECT_EQ(size.height, 2304);
  batch::write_references(folder.path() / "none", file, 1, false);  // of another scan
  batch::write_references(folder.path() / "none", "a.ply", 0, false);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none"));
}

}  // namespace hybrid::testing::e57_images_test
