// What is kept of a scan comes back bit for bit, and damage is found.
#include "archive/kept_scan.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "../e2e/program.hpp"
#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {
namespace fs = std::filesystem;

// Every member set, with sizes around a block's and values that only bits can tell apart.
batch::ProcessedScan sample() {
  std::mt19937 random(1);
  batch::ProcessedScan scan;
  auto& product = scan.product;
  product.id = "west";
  product.input_samples = 123456789012;
  product.input_returns = 7;
  auto& image = product.image;
  image = make_range_image(700, 900);
  for (float& x : image.x) {
    const std::uint32_t bits = static_cast<std::uint32_t>(random());
    std::memcpy(&x, &bits, sizeof x);  // NaNs of all kinds among them
  }
  for (auto& source : image.source) source = static_cast<std::uint32_t>(random());
  image.elevation_rad[3] = 0.1;
  image.wraps = true;
  image.rgb.assign(image.count(), {1, 2, 3});
  image.extra = {1, 5};
  product.segmentation.square = 7;
  product.segmentation.sample_label.assign(image.count(), 3);
  Supercluster cluster;
  cluster.id = 9;
  cluster.plane = {{0.6, 0, 0.8}, 1.25};
  cluster.contours = {{{{1, 2, 3}, {4, 5, 6}}, false}, {}};
  product.segmentation.superclusters = {cluster, {}};
  product.boundary = {1, 0, 1};
  product.intersections = {{{4, 5}, {1, 1, 1}, {2, 2, 2}, 88.5, 12}};
  product.decimation = {{3, 2, 1}, 11, 5};
  product.stray = {0, 2};
  product.sigma_m = 0.0017;
  product.recorded_pose = Pose{2, Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {1, 2, 3}};
  product.notes = {"", "a note"};
  scan.remains.intensity = true;
  scan.remains.crs = "EPSG:27700";
  scan.remains.extra = {{{1, 2, 3}, 0.5f, {7, 8, 9}, 1}};
  Scan whole;
  whole.name = "georeferenced";
  whole.points = {{1, 2, 3}};
  whole.origin = {5e5, 1.8e5, 30};
  whole.range_grid = RangeGrid{{1, 2}, {3}, true, {4}, {{1, 2, 3, 4}}};
  whole.intensity_limits = {0, 255};
  whole.crs_records = {{34735, std::string("\0x", 2)}};
  scan.remains.georeferenced = whole;
  return scan;
}

template <typename T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
}

}  // namespace

TEST(KeptScan, comes_back_bit_for_bit) {
  const e2e::Scratch scratch;
  auto scan = sample();
  write_kept_scan(scratch / "kept.bin", scan);
  auto back = read_kept_scan(scratch / "kept.bin");
  expect_same_bits(back.product.image.x, scan.product.image.x);
  expect_same_bits(back.product.image.source, scan.product.image.source);
  EXPECT_EQ(back.product.segmentation.superclusters[0].contours[0].points[1], Vec3(4, 5, 6));
  EXPECT_FALSE(back.product.segmentation.superclusters[0].contours[0].outer);
  EXPECT_EQ(back.product.recorded_pose->rotation.coeffs(), scan.product.recorded_pose->rotation.coeffs());
  EXPECT_EQ(back.remains.georeferenced->crs_records[0].bytes,
            scan.remains.georeferenced->crs_records[0].bytes);
  // Whatever else there is: written again it gives the same file.
  write_kept_scan(scratch / "again.bin", back);
  EXPECT_EQ(io::read_text(scratch / "again.bin"), io::read_text(scratch / "kept.bin"));
}

TEST(KeptScan, damage_is_an_input_error_wherever_it_is) {
  const e2e::Scratch scratch;
  auto scan = sample();
  scan.product.image = make_range_image(9, 9);
  write_kept_scan(scratch / "kept.bin", scan);
  const std::string whole = io::read_text(scratch / "kept.bin");
  const auto expect_error = [&](const std::string& bytes, std::size_t at) {
    io::write_text(scratch / "bad.bin", bytes);
    try {
      read_kept_scan(scratch / "bad.bin");
      ADD_FAILURE() << "byte " << at << " of " << whole.size();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << at << error.what();
      EXPECT_NE(std::string(error.what()).find("bad.bin: byte"), std::string::npos) << error.what();
    }
  };
  for (std::size_t at = 0; at < whole.size(); at += 1 + at / 40) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 16);
    expect_error(flipped, at);
    expect_error(whole.substr(0, at), at);
  }
  expect_error(whole + "x", whole.size());
}

}  // namespace hybrid::archive
