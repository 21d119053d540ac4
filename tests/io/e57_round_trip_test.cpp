#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/e57_scans.hpp"

namespace hybrid::testing::e57_round_trip_test {
namespace {

constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();

// Fields of every width from 0 to 64 bits, both kinds of reals among them.
std::vector<io::E57Field> fields_of_every_width() {
  std::vector<io::E57Field> fields;
  for (int width = 0; width < 64; ++width) {
    const auto most = static_cast<std::int64_t>((1ull << width) - 1);
    const std::string name = fmt::format("i{}", width);
    if (width % 3 == 0)
      fields.push_back(integer_field(name, -most / 2, most - most / 2));
    else
      fields.push_back(scaled_field(name, -7, most - 7, 0.001, 12.5));
    if (width % 20 == 5) fields.push_back(real_field(fmt::format("s{}", width)));
    if (width % 20 == 6) fields.push_back(real_field(fmt::format("d{}", width), io::E57Type::double_real));
  }
  fields.push_back(integer_field("i64", kLow, kHigh));
  return fields;
}

TEST(E57RoundTrip, EveryWidthAndTypeInPacketsOfAnySize) {
  const TemporaryFolder folder;
  io::E57Scan scan;
  scan.points.fields = fields_of_every_width();
  for (const std::size_t count : {0u, 1u, 7u, 1000u}) {
    const E57Columns columns = random_columns(scan.points.fields, count);
    for (const std::size_t per_packet : {0u, 1u, 3u, 8u, 61u}) {
      const auto file = folder.path() / "west.e57";
      write_e57(file, scan, columns, {.records_per_packet = per_packet});
      const io::E57File read(file);
      ASSERT_EQ(read.contents().scans.size(), 1u);
      EXPECT_TRUE(read.notes().empty()) << read.notes().front();
      ASSERT_EQ(read.contents().scans[0].points.fields.size(), scan.points.fields.size());
      for (std::size_t k = 0; k < scan.points.fields.size(); ++k)
        EXPECT_TRUE(read.contents().scans[0].points.fields[k] == scan.points.fields[k]) << k;
      EXPECT_TRUE(read_columns(read, 0, 64) == columns)
          << count << " records, " << per_packet << " per packet";
    }
  }
}

// More than one block of the reader and many groups of packets, streams of one bit beside streams of 64.
TEST(E57RoundTrip, ManyGroupsOfPackets) {
  const TemporaryFolder folder;
  io::E57Scan scan;
  scan.points.fields = {integer_field("bit", 0, 1), real_field("cartesianX", io::E57Type::double_real),
                        integer_field("rowIndex", 0, 8000), real_field("y")};
  const E57Columns columns = random_columns(scan.points.fields, 300'000);
  const auto file = folder.path() / "west.e57";
  write_e57(file, scan, columns);
  EXPECT_TRUE(read_columns(io::E57File(file), 0, 100'000) == columns);
  // One field alone, from the middle.
  const io::E57File read(file);
  const auto reader = read.open(read.contents().scans[0].points);
  std::vector<std::int64_t> rows(5000);
  const std::array<std::size_t, 1> only = {2};
  reader.read(only, 123'457, rows.size(), [&](const io::E57Records& records) {
    std::ranges::copy(records.integers[0],
                      rows.begin() + static_cast<std::ptrdiff_t>(records.first - 123'457));
  });
  EXPECT_TRUE(std::equal(rows.begin(), rows.end(), columns.integers[2].begin() + 123'457));
}

TEST(E57RoundTrip, DescriptionsPosesAndPictures) {
  const TemporaryFolder folder;
  io::E57Scan scan{.guid = "{A}", .name = "west <wall> & \"door\"", .description = "first\nsecond"};
  scan.original_guids = {"{B}", "{C}"};
  scan.world_from_scan = Pose{1, Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), Vec3(1, 2.5, -1e6 / 3)};
  scan.intensity = io::E57Limits{-0.1, 1.0 / 3};
  scan.colour = std::array{io::E57Limits{0, 255}, io::E57Limits{1, 254}, io::E57Limits{0, 65535}};
  scan.rows = io::E57Limits{0, 9};
  scan.columns = io::E57Limits{3, 17};
  scan.points.fields = {real_field("cartesianX"), real_field("cartesianY"), real_field("nor:normalX")};
  io::E57Image image{.name = "north", .scan_guid = "{A}"};
  image.projection = io::E57Projection::pinhole;
  image.png = true;
  image.width = 40;
  image.height = 30;
  image.focal_length_m = 0.0351;
  image.pixel_width = image.pixel_height = 4.1e-6;
  image.principal_x = 19.5;
  image.principal_y = 14.25;
  image.world_from_image = Pose{1, Eigen::Quaterniond(0, 1, 0, 0), Vec3(0, 0, 1.8)};
  std::string picture(5001, '\0'), mask(3, 'm');
  for (std::size_t i = 0; i < picture.size(); ++i) picture[i] = static_cast<char>(i * 7);

  const auto write = [&](const std::filesystem::path& file) {
    io::E57Writer writer(
        file, {.coordinate_system = "LOCAL_CS[\"hall\"]", .extensions = {{"nor", "http://example.org/nor"}}});
    for (int i = 0; i < 2; ++i) {
      writer.begin_scan(scan);
      writer.write(random_columns(scan.points.fields, 10).records());
      writer.write(random_columns(scan.points.fields, 20).records());
      writer.end_scan();
    }
    writer.add_image(image, picture, mask);
    writer.add_image({.name = "east", .width = 1, .height = 1}, std::span(picture).first(1));
    writer.close();
  };
  const auto file = folder.path() / "site.e57", again = folder.path() / "again.e57";
  write(file);
  write(again);
  EXPECT_EQ(bytes_of(file), bytes_of(again));

  const io::E57File read(file);
  EXPECT_EQ(read.contents().coordinate_system, "LOCAL_CS[\"hall\"]");
  ASSERT_EQ(read.contents().extensions.size(), 1u);
  EXPECT_EQ(read.contents().extensions[0].address, "http://example.org/nor");
  ASSERT_EQ(read.contents().scans.size(), 2u);
  const io::E57Scan& found = read.contents().scans[1];
  EXPECT_EQ(found.guid, scan.guid);
  EXPECT_EQ(found.name, scan.name);
  EXPECT_EQ(found.description, scan.description);
  EXPECT_EQ(found.original_guids, scan.original_guids);
  EXPECT_EQ(row_major(*found.world_from_scan), row_major(*scan.world_from_scan));
  EXPECT_TRUE(found.intensity == scan.intensity);
  EXPECT_TRUE(found.colour == scan.colour);
  EXPECT_TRUE(found.rows == scan.rows);
  EXPECT_TRUE(found.columns == scan.columns);
  EXPECT_EQ(found.points.count, 30u);
  EXPECT_EQ(read_columns(read, 1).reals[2].size(), 30u);
  ASSERT_EQ(read.contents().images.size(), 2u);
  const io::E57Image& shown = read.contents().images[0];
  EXPECT_EQ(shown.scan_guid, "{A}");
  EXPECT_EQ(shown.projection, io::E57Projection::pinhole);
  EXPECT_TRUE(shown.png);
  EXPECT_EQ(shown.focal_length_m, image.focal_length_m);
  EXPECT_EQ(shown.pixel_width, image.pixel_width);
  EXPECT_EQ(shown.principal_x, image.principal_x);
  EXPECT_EQ(shown.principal_y, image.principal_y);
  EXPECT_EQ(row_major(*shown.world_from_image), row_major(*image.world_from_image));
  const auto text = [](const std::vector<char>& bytes) { return std::string(bytes.begin(), bytes.end()); };
  EXPECT_EQ(text(read.read_blob(shown.picture, "picture")), picture);
  EXPECT_EQ(text(read.read_blob(*shown.mask, "mask")), mask);
  EXPECT_EQ(text(read.read_blob(read.contents().images[1].picture, "picture")), picture.substr(0, 1));
  EXPECT_FALSE(read.contents().images[1].guid.empty());
}

TEST(E57RoundTrip, ValuesThatDoNotFitAreErrors) {
  const TemporaryFolder folder;
  io::E57Scan scan;
  scan.points.fields = {integer_field("i", 0, 4), real_field("r")};
  io::E57Writer writer(folder.path() / "a.e57");
  writer.begin_scan(scan);
  E57Columns columns{{{1, 5}, {}}, {{}, {0.5, 0.5}}};
  EXPECT_TRUE(holds(error_of(ErrorKind::failed, [&] { writer.write(columns.records()); }), "point 1"));
  columns = {{{1, 2}, {}}, {{}, {0.5, 0.1}}};
  EXPECT_TRUE(holds(error_of(ErrorKind::failed, [&] { writer.write(columns.records()); }), "field r"));
  for (const char* name : {"", "a b", "1a", "a:b:c", "a:", "<"}) {
    scan.points.fields[0].name = name;
    io::E57Writer other(folder.path() / "b.e57");
    EXPECT_TRUE(holds(error_of(ErrorKind::failed, [&] { other.begin_scan(scan); }), "XML name"));
  }
}

}  // namespace
}  // namespace hybrid::testing::e57_round_trip_test
