#include <gtest/gtest.h>

#include <cmath>

#include "io/e57_scans.hpp"
#include "io/read_scans.hpp"

namespace hybrid::testing::e57_samples_test {
namespace {

struct Sample {
  const char* file;
  int scans = 1;
  std::size_t points = 0;         // of the first scan
  std::array<double, 3> first{};  // its first point, metres
  const char* error = nullptr;    // instead: refused with this in the message
  int images = 0;
};

// Counts, coordinates and refusals as an independent decoder gives them, where it reads the file.
constexpr Sample kSamples[] = {
    {"e57-cry-inc/bunnyDouble.e57", 1, 30571, {-0.07063, 0.04015, 0.001226}},
    {"e57-cry-inc/bunnyFloat.e57", 1, 30571, {-0.07063, 0.04015, 0.001226}},
    {"e57-cry-inc/bunnyInt19.e57", 1, 30571, {-0.07063, 0.04015, 0.001226}},
    {"e57-cry-inc/bunnyInt21.e57", 1, 30571, {-0.07063, 0.04015, 0.001226}},
    {"e57-cry-inc/bunnyInt24.e57", 1, 30571, {-0.07063, 0.04015, 0.001226}},
    {"e57-cry-inc/bunnyInt32.e57", 1, 30571, {-0.07063, 0.04015, 0.001226}},
    {"e57-cry-inc/cartesian_invalid_state_single.e57", 1, 3, {-1, -2, -3}},
    {"e57-cry-inc/empty.e57", 0},
    {"e57-cry-inc/empty_pc.e57", 1, 0},
    {"e57-cry-inc/float_intensity_without_min_max.e57", 1, 1, {1, 1, 1}},
    {"e57-cry-inc/integer_intensity.e57", 1, 2, {1.1, 2.2, 3.3}},
    {"e57-cry-inc/las2e57_no_images_tag.e57", 1, 153, {-0.5, -0.015, -0.432}},
    {"e57-cry-inc/no_ext_namespace.e57", 1, 1, {1, 2, 3}},
    {"e57-cry-inc/original_guids.e57", 1, 1, {1, 2, 3}},
    {"e57-cry-inc/read_error.e57", 1, 2651, {0, 0, 0}},
    {"e57-cry-inc/scaled_integer_intensity.e57", 1, 2, {1.1, 2.2, 3.3}},
    {"e57-cry-inc/tinyCartesianFloatRgb.e57",
     1,
     2090,
     {-8.673629760742188, 4.575418472290039, 295.54946899414062}},
    {"e57-cry-inc/tiny_pc_and_images.e57", 1, 2, {0, 0, 0}, nullptr, 4},
    {"e57-cry-inc/tiny_pc_with_extension.e57", 1, 1, {1, 2, 3}},
    {"e57-libe57format/ColouredCubeDouble.e57", 1, 7680, {-0.5, -0.499055922, 0.0713629127}},
    {"e57-libe57format/ColouredCubeFloat.e57", 1, 7680, {-0.5, -0.499055922, 0.0713629127}},
    {"e57-libe57format/InvalidCVHeader.e57",
     1,
     0,
     {},
     "byte 48: scan 0: expected a section of points (1), found 182"},
    {"e57-libe57format/PinholeImageWithDistortionParameters.e57", 0, 0, {}, nullptr, 3},
    {"e57-libe57format/ZeroPoints.e57", 1, 0},
    {"e57-libe57format/ZeroPointsInvalid.e57", 1, 0, {}, "expected an offset of 48 to 2047, found 0"},
    {"e57-libe57format/bad-crc.e57", 1, 0, {}, "byte 0 (page 0): expected checksum 360e223d, found 1392e413"},
    {"e57-libe57format/empty.e57", 0},
    {"e57-pye57/pumpAVisualReferenceImage.e57", 1, 155201, {1.702286, -3.193588, -1.841843}, nullptr, 1},
    {"e57-pye57/testWithNormals.e57", 1, 2, {1, 0, 0}},
    {"e57-pye57/translationWithoutRotation.e57", 1, 4, {0, 0, 0}},
};

std::filesystem::path sample(const std::string& name) {
  return real_data("scans/" + name);
}

bool has_note(const std::vector<std::string>& notes, const std::string& part) {
  return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(part) != note.npos; });
}

TEST(E57Samples, EachReadsOrFailsAsItShould) {
  if (!std::filesystem::exists(sample("e57-cry-inc")))
    GTEST_SKIP() << "needs scans/e57-* under ../shared/data or HYBRID_DATA";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(real_data("scans")))
    files += entry.path().extension() == ".e57";
  EXPECT_EQ(files, std::size(kSamples)) << "a sample file without a row";
  for (const Sample& row : kSamples) {
    SCOPED_TRACE(row.file);
    if (row.error) {
      const std::string message = error_of(ErrorKind::input, [&] { read_scans(sample(row.file)); });
      EXPECT_TRUE(holds(message, row.error));
      EXPECT_TRUE(message.starts_with(sample(row.file).string()));
      continue;
    }
    const io::E57File file(sample(row.file));
    ASSERT_EQ(file.contents().scans.size(), static_cast<std::size_t>(row.scans));
    ASSERT_EQ(file.contents().images.size(), static_cast<std::size_t>(row.images));
    for (const io::E57Image& image : file.contents().images)
      EXPECT_EQ(file.read_blob(image.picture, "image").size(), image.picture.length);
    if (row.scans == 0) continue;
    const Scan scan = io::read_e57(file, 0);
    ASSERT_EQ(scan.points.size(), row.points);
    if (row.points == 0) continue;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(scan.point(0)[k], row.first[static_cast<std::size_t>(k)], 1e-7 * 300);
  }
}

TEST(E57Samples, WhatTheyHoldBesidesPoints) {
  if (!std::filesystem::exists(sample("e57-cry-inc")))
    GTEST_SKIP() << "needs scans/e57-* under ../shared/data or HYBRID_DATA";
  const auto read = [](const std::string& name) { return read_scans(sample(name)).at(0); };
  // The double and the 19-bit file hold the same bunny, in micrometres.
  const Scan exact = read("e57-cry-inc/bunnyDouble.e57"), rounded = read("e57-cry-inc/bunnyInt19.e57");
  for (std::size_t i = 0; i < exact.points.size(); ++i)
    ASSERT_LT((exact.point(i) - rounded.point(i)).norm(), 1e-6) << i;

  const Scan marked = read("e57-cry-inc/cartesian_invalid_state_single.e57");
  EXPECT_TRUE(std::isnan(marked.points[1][0]) && std::isnan(marked.points[2][0]));
  EXPECT_TRUE(has_note(marked.notes, "2 of 3 points are marked invalid"));
  EXPECT_EQ(read("e57-cry-inc/integer_intensity.e57").intensity, (std::vector<float>{-66, 66}));
  EXPECT_EQ(read("e57-cry-inc/scaled_integer_intensity.e57").intensity, (std::vector<float>{-66.6f, 66.6f}));
  EXPECT_TRUE(has_note(read("e57-cry-inc/las2e57_no_images_tag.e57").notes, "no images2D"));
  EXPECT_TRUE(has_note(read("e57-cry-inc/tiny_pc_with_extension.e57").notes, "fields not used: nor:normalX"));
  EXPECT_EQ(read("e57-cry-inc/tinyCartesianFloatRgb.e57").rgb[0],
            (std::array<std::uint8_t, 3>{219, 218, 222}));

  const Scan moved = read("e57-pye57/translationWithoutRotation.e57");
  ASSERT_TRUE(moved.world_from_scan);
  EXPECT_EQ(moved.world_from_scan->translation, Vec3(4, 5, 6));
  EXPECT_EQ(moved.world_from_scan->rotation.w(), 1);
  EXPECT_EQ(io::E57File(sample("e57-cry-inc/original_guids.e57")).contents().scans[0].original_guids,
            (std::vector<std::string>{"guid1", "guid2", "guid3"}));

  const io::E57File images(sample("e57-cry-inc/tiny_pc_and_images.e57"));
  const auto& list = images.contents().images;
  EXPECT_EQ(list[0].projection, io::E57Projection::visual_reference);
  EXPECT_EQ(list[1].projection, io::E57Projection::spherical);
  EXPECT_EQ(list[2].projection, io::E57Projection::pinhole);
  EXPECT_EQ(list[3].projection, io::E57Projection::cylindrical);
  EXPECT_EQ(list[1].scan_guid, images.contents().scans[0].guid);
  EXPECT_NEAR(list[1].world_from_image->rotation.norm(), 1, 1e-15);
  EXPECT_TRUE(has_note(list[1].notes, "normalised"));
  EXPECT_EQ(list[2].focal_length_m, 123);
  EXPECT_EQ(list[2].principal_x, 23);
  EXPECT_EQ(list[3].radius_m, 666);
}

TEST(E57Samples, PumpRoomLiesOnItsGrid) {
  const std::string name = "e57-pye57/pumpAVisualReferenceImage.e57";
  if (!std::filesystem::exists(sample(name)))
    GTEST_SKIP() << "needs scans/e57-pye57 under ../shared/data or HYBRID_DATA";
  const io::E57File file(sample(name));
  const Scan scan = io::read_e57(file, 0);
  EXPECT_EQ(scan.grid_rows, 1074);
  EXPECT_EQ(scan.grid_cols, 345);
  ASSERT_EQ(scan.node.size(), scan.points.size());
  std::vector<int> taken(1074 * 345);
  for (const std::uint32_t node : scan.node) ASSERT_EQ(taken.at(node)++, 0);
  // The azimuth is nearly constant per column.
  std::vector<double> azimuth(345, NAN);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Vec3 p = scan.point(i);
    double& known = azimuth[scan.node[i] % 345];
    if (std::isnan(known)) known = std::atan2(p.y(), p.x());
    ASSERT_NEAR(std::atan2(p.y(), p.x()), known, 1e-2);  // the head's parallax; 345 columns take 1.5
  }
  EXPECT_EQ(scan.intensity.size(), scan.points.size());
  EXPECT_EQ(scan.rgb[0], (std::array<std::uint8_t, 3>{51, 65, 49}));
  const auto picture = file.read_blob(file.contents().images.at(0).picture, "image");
  EXPECT_EQ(static_cast<unsigned char>(picture[0]), 0xff);
  EXPECT_EQ(static_cast<unsigned char>(picture[1]), 0xd8);
}

}  // namespace
}  // namespace hybrid::testing::e57_samples_test
