#include "io/exr/exr_scan.hpp"
#include "geometry/vectors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/exr/range_exr.hpp"
#include "io/foreign_exr.hpp"
#include "io/ply/ply.hpp"
#include "io/scan_files.hpp"
#include "stages/scan/organised_grid.hpp"

namespace hybrid::testing::exr_scan_test {
namespace {

// Every third node empty, every seventh interpolated, two samples beside the grid.
RangeImage some_image(int rows, int cols) {
  RangeImage image = make_range_image(rows, cols);
  for (int row = 0; row < rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = 0.6 - 0.0113 * row;
  for (int col = 0; col < cols; ++col) image.azimuth_rad[static_cast<std::size_t>(col)] = -3.1 + 0.0171 * col;
  image.wraps = true;
  image.intensity.assign(image.count(), 0.0f);
  image.rgb.assign(image.count(), {0, 0, 0});
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (i % 3 == 0) continue;
    const double t = static_cast<double>(i);
    image.x[i] = static_cast<float>(3 + std::sin(t));
    image.y[i] = static_cast<float>(2 * std::cos(t));
    image.z[i] = static_cast<float>(std::sin(0.7 * t));
    image.range_m[i] = static_cast<float>(image.point(i).norm());
    image.mask[i] = i % 7 == 0 ? kInterpolated : kMeasured;
    if (image.mask[i] == kInterpolated) {
      image.range_m[i] = std::nextafter(image.range_m[i], 9.0f);  // it was what the interpolation gave
      continue;
    }
    image.source[i] = static_cast<std::uint32_t>(2 * i);
    image.intensity[i] = static_cast<float>(t) / 1000;
    image.rgb[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 3), 255};
  }
  return image;
}

void expect_same(const RangeImage& a, const RangeImage& b) {
  const auto same = [](const auto& one, const auto& other, const char* what) {
    ASSERT_EQ(one.size(), other.size()) << what;
    EXPECT_EQ(std::memcmp(one.data(), other.data(), one.size() * sizeof(one[0])), 0) << what;
  };
  EXPECT_EQ(a.wraps, b.wraps);
  same(a.elevation_rad, b.elevation_rad, "elevation");
  same(a.azimuth_rad, b.azimuth_rad, "azimuth");
  same(a.range_m, b.range_m, "range");
  same(a.x, b.x, "x");
  same(a.y, b.y, "y");
  same(a.z, b.z, "z");
  same(a.mask, b.mask, "mask");
  same(a.intensity, b.intensity, "intensity");
  same(a.rgb, b.rgb, "rgb");
}

}  // namespace

TEST(ExrScan, ARangeImageFedInAgainIsTheSameImage) {
  const ScanFolder folder;
  RangeImage image = some_image(300, 270);  // two rows of tiles
  image.extra = {3, 9};
  io::write_range_exr(folder.path("range.exr"), image,
                      {{"source", "a.ptx"}, {"world_from_scan", "[0,-1,0,5, 1,0,0,6, 0,0,1,7, 0,0,0,1]"}});
  io::PlyPoint beside;
  beside.position = {1, 2, 3};
  beside.intensity = 0.5f;
  beside.rgb = {7, 8, 9};
  io::write_ply(folder.path("extra.ply"), {beside, beside}, {.intensity = true, .colour = true});

  const Scan scan = io::read_exr_scan(folder.path("range.exr"));
  EXPECT_EQ(scan.name, "range");
  EXPECT_EQ(scan.notes, std::vector<std::string>{"source: a.ptx"});
  ASSERT_TRUE(scan.world_from_scan);
  EXPECT_EQ(scan.world_from_scan->translation, Vec3(5, 6, 7));
  const std::size_t nodes = image.count();
  ASSERT_EQ(scan.points.size(), nodes + 2);
  EXPECT_EQ(scan.points[nodes], (std::array<float, 3>{1, 2, 3}));
  EXPECT_EQ(scan.intensity[nodes + 1], 0.5f);
  EXPECT_EQ(scan.rgb[nodes + 1], (std::array<std::uint8_t, 3>{7, 8, 9}));
  for (std::size_t i = 0; i < nodes; ++i)  // interpolated nodes are no samples
    ASSERT_EQ(std::isfinite(scan.points[i][0]), image.mask[i] == kMeasured) << i;

  const RangeImage again = stages::arrange_grid(scan);
  expect_same(again, image);
  for (std::size_t i = 0; i < nodes; ++i)
    ASSERT_EQ(again.source[i], image.mask[i] == kMeasured ? i : kNoSource) << i;
  EXPECT_EQ(again.extra, (std::vector<std::uint32_t>{81000, 81001}));
}

TEST(ExrScan, NoReturnAtAllIsSaid) {
  const ScanFolder folder;
  RangeImage image = make_range_image(4, 5);
  io::write_range_exr(folder.path("range.exr"), image, {});
  const Scan scan = io::read_exr_scan(folder.path("range.exr"));
  expect_input_error([&] { stages::arrange_grid(scan); },
                     {"expected returns, found none in a grid of 4 x 5", "leave it out"});
}

TEST(ExrScan, SamplesBesideTheGridMayBeMissingButNotOthers) {
  const ScanFolder folder;
  RangeImage image = some_image(4, 5);
  image.extra = {3, 9};
  io::write_range_exr(folder.path("range.exr"), image, {});
  const Scan scan = io::read_exr_scan(folder.path("range.exr"));
  EXPECT_EQ(scan.points.size(), 20u);
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_NE(scan.notes[0].find("2 samples beside the grid are missing"), std::string::npos);
  io::write_ply(folder.path("extra.ply"), {io::PlyPoint{}}, {});
  expect_input_error([&] { io::read_exr_scan(folder.path("range.exr")); },
                     {"extra.ply: expected 2 points", "found 1"});
}

// Points only, in all layouts and compressions that keep floats.
TEST(ExrScan, AnotherProgramsPoints) {
  const ScanFolder folder;
  const auto file = folder.path("other.exr");
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                 Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::DWAA_COMPRESSION})
    for (const int tile : {0, 16, 64, 700}) {
      SCOPED_TRACE(fmt::format("compression {}, tile {}", static_cast<int>(compression), tile));
      ForeignExr exr(70, 300);
      exr.compression = compression;
      exr.tile = tile;
      exr.corner = {-3, 5};
      for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
      exr.channel("x")[71] = kNaN;
      exr.channel("x")[72] = exr.channel("y")[72] = exr.channel("z")[72] = 0;
      exr.write(file);
      const Scan scan = io::read_exr_scan(file);
      EXPECT_EQ(scan.grid_rows, 300);
      EXPECT_EQ(scan.grid_cols, 70);
      EXPECT_TRUE(scan.row_by_row);
      EXPECT_FALSE(scan.range_grid);
      EXPECT_TRUE(scan.intensity.empty() && scan.rgb.empty() && !scan.world_from_scan);
      ASSERT_EQ(scan.points.size(), 21000u);
      for (std::size_t i = 0; i < 21000; ++i) {
        if (i == 71 || i == 72)
          ASSERT_TRUE(std::isnan(scan.points[i][0])) << i;
        else
          for (std::size_t axis = 0; axis < 3; ++axis)
            ASSERT_EQ(scan.points[i][axis], exr.channel(std::string(1, "xyz"[axis]))[i]) << i;
      }
    }
}

TEST(ExrScan, AnotherProgramsRanges) {
  const ScanFolder folder;
  ForeignExr exr(7, 3);
  exr.add("range", Imf::FLOAT);
  exr.channel("range")[4] = -2;
  exr.channel("range")[5] = kNaN;
  exr.add("intensity", Imf::HALF);
  for (const char* name : {"R", "G", "B"}) exr.add(name, Imf::FLOAT);
  exr.channel("R")[8] = 0.2140411f;  // sRGB 127
  exr.attribute("hybrid:elevation_first_rad", 0.5);
  exr.attribute("hybrid:elevation_step_rad", -0.25);
  exr.attribute("hybrid:azimuth_rad", std::string("-3 -2 -1 0 1 2 3"));
  exr.write(folder.path("r.exr"));
  const Scan scan = io::read_exr_scan(folder.path("r.exr"));
  ASSERT_TRUE(scan.range_grid);
  EXPECT_EQ(scan.range_grid->elevation_rad, (std::vector<double>{0.5, 0.25, 0}));
  EXPECT_TRUE(scan.range_grid->wraps);  // 6 rad of 2 pi, a step of 1 rad
  EXPECT_TRUE(std::isnan(scan.points[4][0]) && std::isnan(scan.points[5][0]));
  const double range = static_cast<double>(exr.channel("range")[8]);  // row 1, column 1
  EXPECT_NEAR(static_cast<double>(scan.points[8][0]), range * std::cos(0.25) * std::cos(-2), 1e-6);
  EXPECT_NEAR(static_cast<double>(scan.points[8][1]), range * std::cos(0.25) * std::sin(-2), 1e-6);
  EXPECT_NEAR(static_cast<double>(scan.points[8][2]), range * std::sin(0.25), 1e-6);
  EXPECT_EQ(scan.intensity.size(), 21u);
  EXPECT_EQ(scan.rgb[8][0], 127);
}

TEST(ExrScan, TablesThatRunTheOtherWayPlaceTheRanges) {
  const ScanFolder folder;
  ForeignExr exr(4, 3);
  exr.add("range", Imf::FLOAT);
  exr.attribute("hybrid:elevation_rad", std::string("-0.1, 0, 0.1"));
  exr.attribute("hybrid:azimuth_rad", std::string("0.3 0.2 0.1 0"));
  exr.write(folder.path("r.exr"));
  const Scan scan = io::read_exr_scan(folder.path("r.exr"));
  EXPECT_FALSE(scan.range_grid);
  const RangeImage image = stages::arrange_grid(scan);
  EXPECT_NEAR(image.elevation_rad[0], 0.1, 1e-6);
  EXPECT_NEAR(image.azimuth_rad[0], 0, 1e-6);
  EXPECT_EQ(image.source[0], 11u);
}

TEST(ExrScan, TheMaskDecidesWhatIsASample) {
  const ScanFolder folder;
  ForeignExr exr(3, 2);
  for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
  exr.channel("x")[5] = kNaN;
  exr.add("mask", Imf::UINT);
  exr.channel("mask") = {1, 0, 2, 1, 2, 1};
  exr.write(folder.path("m.exr"));
  const Scan scan = io::read_exr_scan(folder.path("m.exr"));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(std::isfinite(scan.points[i][0]), i == 0 || i == 3) << i;
  EXPECT_EQ(scan.notes.size(), 2u);  // node 5; two interpolated ones, without tables to keep them in
}

}  // namespace hybrid::testing::exr_scan_test
