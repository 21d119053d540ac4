#include "io/exr/range_exr.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "io/scan_files.hpp"

namespace hybrid::testing::range_exr_test {
namespace {

// Every third sample empty, every seventh interpolated; angles that no short decimal gives.
RangeImage some_image(int rows, int cols, bool intensity, bool colour) {
  RangeImage image = make_range_image(rows, cols);
  image.wraps = cols % 2 == 0;
  for (std::size_t i = 0; i < image.elevation_rad.size(); ++i)
    image.elevation_rad[i] = 1.2 - static_cast<double>(i) / 3.7;
  for (std::size_t i = 0; i < image.azimuth_rad.size(); ++i)
    image.azimuth_rad[i] = static_cast<double>(i) * 0.1 - M_PI;
  if (intensity) image.intensity.resize(image.count());
  if (colour) image.rgb.resize(image.count());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < image.count(); ++i) {
    const bool empty = i % 3 == 0;
    const auto t = static_cast<float>(i);
    image.mask[i] = empty ? kEmpty : (i % 7 == 0 ? kInterpolated : kMeasured);
    image.source[i] = image.mask[i] == kMeasured ? static_cast<std::uint32_t>(4000000000u - i) : kNoSource;
    image.x[i] = empty ? nan : std::sin(t);
    image.y[i] = empty ? nan : 3 * std::cos(t);
    image.z[i] = empty ? nan : -0.0f;
    image.range_m[i] = empty ? nan : std::hypot(image.x[i], image.y[i]);
    if (intensity) image.intensity[i] = t / 1000;
    if (colour) image.rgb[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 3), 255};
  }
  if (image.count() > 2) image.x[2] = std::bit_cast<float>(0x7fa12345u);  // a NaN's bits are content
  return image;
}

template <typename T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0) << what;
}

void expect_same(const RangeImage& a, const RangeImage& b) {
  ASSERT_EQ(a.rows, b.rows);
  ASSERT_EQ(a.cols, b.cols);
  EXPECT_EQ(a.wraps, b.wraps);
  expect_same_bits(a.elevation_rad, b.elevation_rad, "elevation");
  expect_same_bits(a.azimuth_rad, b.azimuth_rad, "azimuth");
  expect_same_bits(a.range_m, b.range_m, "range");
  expect_same_bits(a.x, b.x, "x");
  expect_same_bits(a.y, b.y, "y");
  expect_same_bits(a.z, b.z, "z");
  expect_same_bits(a.mask, b.mask, "mask");
  expect_same_bits(a.source, b.source, "source");
  expect_same_bits(a.intensity, b.intensity, "intensity");
  expect_same_bits(a.rgb, b.rgb, "rgb");
}

TEST(RangeExr, RoundTripIsExactAndRepeatable) {
  const ScanFolder folder;
  const int sizes[][2] = {{1, 1}, {1, 300}, {300, 1}, {17, 31}, {256, 256}, {257, 513}, {600, 90}};
  int variant = 0;
  for (const auto& [rows, cols] : sizes) {
    SCOPED_TRACE(fmt::format("{} x {}", rows, cols));
    const RangeImage image = some_image(rows, cols, (variant & 1) != 0, (variant & 2) != 0);
    ++variant;
    const auto file = folder.path("scans/west/range.exr");
    const std::map<std::string, std::string> attributes{{"source", "scans/west wall.ptx"},
                                                        {"crs", "EPSG:27700"}};
    io::write_range_exr(file, image, attributes);
    expect_same(io::read_range_exr(file), image);
    EXPECT_EQ(io::read_range_exr_attributes(file), attributes);
    const std::string first = bytes_of(file);
    io::write_range_exr(file, image, attributes);
    EXPECT_EQ(bytes_of(file), first);
  }
}

TEST(RangeExr, EveryColourByteSurvivesLinearLight) {
  const ScanFolder folder;
  RangeImage image = make_range_image(1, 256);
  image.rgb.resize(256);
  for (std::size_t i = 0; i < 256; ++i)
    image.rgb[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i), 7};
  io::write_range_exr(folder.path("c.exr"), image, {});
  expect_same(io::read_range_exr(folder.path("c.exr")), image);
}

TEST(RangeExr, WhatCannotBeWrittenIsRefused) {
  const ScanFolder folder;
  const auto file = folder.path("no.exr");
  EXPECT_THROW(io::write_range_exr(file, make_range_image(0, 5), {}), Error);
  EXPECT_THROW(io::write_range_exr(file, make_range_image(2, 5), {{"wraps", "1"}}), Error);
  RangeImage lacking = make_range_image(2, 5);
  lacking.source.pop_back();
  EXPECT_THROW(io::write_range_exr(file, lacking, {}), Error);
  EXPECT_FALSE(std::filesystem::exists(file));
}

class RangeExrDamage : public ::testing::Test {
 protected:
  void SetUp() override {
    io::write_range_exr(folder_.path("intact.exr"), some_image(300, 290, true, true), {{"source", "a.ptx"}});
    intact_ = bytes_of(folder_.path("intact.exr"));
  }
  void expect_error(const std::string& bytes, const char* part) const {
    const auto file = folder_.write("damaged scan.exr", bytes);
    expect_input_error([&] { io::read_range_exr(file); }, {file.string() + ": ", part});
  }
  ScanFolder folder_;
  std::string intact_;
};

TEST_F(RangeExrDamage, OtherFiles) {
  expect_error("", "empty");
  expect_error("ply\nformat ascii 1.0\n", "byte 0: expected an OpenEXR file");
  expect_error(std::string("\x76\x2f\x31\x01\x02\x08\0\0", 8), "byte 4: expected a flat image");
  expect_input_error([&] { io::read_range_exr(folder_.path("none.exr")); }, {"no such file"});
  expect_input_error([&] { io::read_range_exr(folder_.path("")); }, {"folder"});
}

TEST_F(RangeExrDamage, EveryCutIsFound) {
  for (std::size_t i = 1; i <= 40; ++i)
    expect_error(intact_.substr(0, i * (intact_.size() - 1) / 40), "expected");
  for (std::size_t size = 1; size < 1500; size += 7) expect_error(intact_.substr(0, size), "expected");
}

// A bit of the compressed data that changes no sample may pass; a changed sample may not.
TEST_F(RangeExrDamage, EveryFlippedByteOfTheTilesIsFound) {
  const RangeImage image = io::read_range_exr(folder_.path("intact.exr"));
  const std::size_t header = intact_.size() / 10;  // beyond the header and the table of offsets
  int found = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    std::string bytes = intact_;
    char& byte = bytes[header + i * (bytes.size() - header - 1) / 59];
    byte = static_cast<char>(byte ^ 0x10);
    const auto file = folder_.write("flipped.exr", bytes);
    try {
      expect_same(io::read_range_exr(file), image);
    } catch (const Error& error) {
      ++found;
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
      EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
    }
  }
  EXPECT_GE(found, 55);
}

TEST_F(RangeExrDamage, HugeDataWindowIsFoundBeforeAllocation) {
  std::string bytes = intact_;
  const std::size_t window = bytes.find("dataWindow") + 11 + 6 + 4;
  bytes.replace(window + 8, 8, raw(2000000000) + raw(2000000000));
  expect_error(bytes, "tiles");
  bytes.replace(window + 8, 8, raw(-2) + raw(5));
  expect_error(bytes, "data window");
}

TEST_F(RangeExrDamage, AttributeSizeBeyondTheFile) {
  std::string bytes = intact_;
  bytes.replace(bytes.find("hybrid:source") + 14 + 7, 4, raw(0x7fffffff));
  expect_error(bytes, "hybrid:source");
}

}  // namespace
}  // namespace hybrid::testing::range_exr_test
