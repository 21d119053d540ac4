#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "io/exr/range_exr.hpp"
#include "shared/labels_exr.hpp"
#include "shared/points_ply.hpp"
#include "shared/pose_json.hpp"
#include "shared/proxy_obj.hpp"
#include "shared/range_exr.hpp"

namespace hybrid::peers {
namespace {

struct Exchange : testing::Test {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("hybrid-peers-" + std::to_string(getpid()));
  Exchange() { std::filesystem::create_directories(folder / "in" / "scans" / "west"); }
  ~Exchange() override { std::filesystem::remove_all(folder); }

  // Written by our own writer, larger than a tile, with holes and interpolated nodes.
  RangeImage write_range() {
    RangeImage image = make_range_image(300, 270);
    for (std::size_t i = 0; i < image.count(); ++i) {
      image.elevation_rad[i / 270] = 1 - 0.001 * static_cast<double>(i / 270);
      image.azimuth_rad[i % 270] = 0.001 * static_cast<double>(i % 270);
      if (i % 7 == 3) continue;
      image.mask[i] = i % 5 == 0 ? kInterpolated : kMeasured;
      image.x[i] = 5 + 0.001f * static_cast<float>(i % 270);
      image.y[i] = -0.25f * static_cast<float>(i);
      image.z[i] = 2;
      image.range_m[i] = std::hypot(image.x[i], image.y[i], image.z[i]);
      if (image.mask[i] == kMeasured) image.source[i] = static_cast<std::uint32_t>(i);
    }
    io::write_range_exr(range(), image, {});
    return image;
  }
  std::filesystem::path range() const { return folder / "in" / "scans" / "west" / "range.exr"; }
};

TEST_F(Exchange, PeersSeeTheSamplesWeWrote) {
  const RangeImage image = write_range();
  const RangeScan scan = read_range_exr(range());
  ASSERT_EQ(scan.rows, image.rows);
  ASSERT_EQ(scan.cols, image.cols);
  for (std::size_t i = 0; i < image.count(); ++i) {
    ASSERT_EQ(scan.mask[i], image.mask[i]) << i;
    if (image.mask[i] == kEmpty) {
      ASSERT_TRUE(std::isnan(scan.x[i])) << i;
      continue;
    }
    ASSERT_EQ(scan.x[i], image.x[i]) << i;
    ASSERT_EQ(scan.y[i], image.y[i]) << i;
    ASSERT_EQ(scan.z[i], image.z[i]) << i;
  }
  EXPECT_EQ(scan.measured(),
            static_cast<std::size_t>(std::count(image.mask.begin(), image.mask.end(), kMeasured)));
}

TEST_F(Exchange, LabelsComeBackBesideTheirRangeImage) {
  const RangeImage image = write_range();
  std::vector<std::uint32_t> labels(image.count());
  for (std::size_t i = 0; i < labels.size(); ++i)
    labels[i] = static_cast<std::uint32_t>(i % 50) * 100'000'000u;
  write_result_folder(folder / "out", range(), image.rows, image.cols, labels);
  const auto result = folder / "out" / "scans" / "west";
  EXPECT_EQ(read_labels_exr(result / "labels.exr", image.rows, image.cols), labels);
  EXPECT_TRUE(std::filesystem::equivalent(result / "range.exr", range()));
  EXPECT_THROW(read_labels_exr(result / "labels.exr", image.rows, image.cols + 1), std::runtime_error);
  write_result_folder(folder / "out", range(), image.rows, image.cols, labels);  // a second run
  EXPECT_THROW(write_result_folder(folder / "in", range(), image.rows, image.cols, labels),
               std::runtime_error);
  EXPECT_EQ(read_range_exr(range()).rows, image.rows);  // the input is still there
}

TEST_F(Exchange, WrongFilesSayWhatWasExpected) {
  write_labels_exr(folder / "labels.exr", 1, 2, {1, 2});
  std::ofstream(folder / "text.exr") << "no picture";
  for (const char* name : {"labels.exr", "text.exr", "absent.exr"}) {
    try {
      read_range_exr(folder / name);
      ADD_FAILURE() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(write_labels_exr(folder / "labels.exr", 2, 2, {1, 2}), std::runtime_error);
}

TEST_F(Exchange, HolesAreTakenOutAndFilled) {
  RangeScan scan;
  scan.rows = 1;
  scan.cols = 10;
  scan.mask = {1, 0, 0, 1, 2, 0, 1, 0, 0, 0};
  for (std::size_t i = 0; i < 10; ++i) {
    const float value = scan.mask[i] ? static_cast<float>(i) : NAN;
    scan.x.push_back(scan.mask[i] ? 100 : NAN);
    scan.y.push_back(value);
    scan.z.push_back(scan.mask[i] ? 0 : NAN);
  }
  EXPECT_EQ(with_holes(scan).mask, (std::vector<std::uint8_t>{1, 0, 0, 1, 0, 0, 1, 0, 0, 0}));
  const RangeScan filled = with_holes_filled(scan);
  EXPECT_EQ(filled.mask, (std::vector<std::uint8_t>{1, 2, 2, 1, 2, 2, 1, 0, 0, 0}));
  EXPECT_FLOAT_EQ(filled.y[2], 2);
  scan.x[6] = 150;  // a jump in depth is not bridged
  EXPECT_EQ(with_holes_filled(scan).mask[5], 0);
  EXPECT_EQ(with_holes_filled(scan, 1).mask[1], 0);  // nor a gap that is too long
}

TEST_F(Exchange, PointsComeBack) {
  const std::vector<PlyPoint> points = {{1, 2, 3, 0, 0, 1, 0.5f}, {4, 5, 6, 0, 1, 0, 0.25f}};
  write_points_ply(folder / "points.ply", points);
  EXPECT_EQ(read_points_ply(folder / "points.ply"), points);
  std::filesystem::resize_file(folder / "points.ply", std::filesystem::file_size(folder / "points.ply") - 1);
  EXPECT_THROW(read_points_ply(folder / "points.ply"), std::runtime_error);
  std::ofstream(folder / "other.ply") << "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n";
  EXPECT_THROW(read_points_ply(folder / "other.ply"), std::runtime_error);
}

TEST_F(Exchange, ProxyIsSampledEvenlyByArea) {
  std::ofstream(folder / "proxy.obj")
      << "# two faces, one twice the other\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
         "v 0 0 2\nv 1 0 2\nf 1 2 3 4\nf 1 2 6 5\n";
  const ProxyMesh mesh = read_proxy_obj(folder / "proxy.obj");
  EXPECT_EQ(mesh.triangles.size(), 4u);
  const SampledProxy sampled = sample_proxy(mesh, 9000);
  std::size_t on_floor = 0;
  for (std::size_t i = 0; i < sampled.points.size(); ++i) on_floor += sampled.normals[i].z() > 0.5f;
  EXPECT_NEAR(static_cast<double>(on_floor), 3000, 200);
  std::ofstream(folder / "bad.obj") << "v 0 0 0\nf 1 2 3\n";
  EXPECT_THROW(read_proxy_obj(folder / "bad.obj"), std::runtime_error);
}

TEST(PoseError, IsAngleAndDistance) {
  Eigen::Matrix4d truth = Eigen::Matrix4d::Identity(), pose = truth;
  pose.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(1e-5 * std::numbers::pi / 180, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  pose(1, 3) = 0.002;
  EXPECT_NEAR(pose_error(pose, truth).angle_deg, 1e-5, 1e-10);
  EXPECT_NEAR(pose_error(pose, truth).distance_mm, 2, 1e-9);
  EXPECT_EQ(matrix_of(json_of(pose)), pose);
  EXPECT_THROW(matrix_of({1, 2}), std::runtime_error);
}

}  // namespace
}  // namespace hybrid::peers
