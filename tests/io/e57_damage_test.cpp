#include <gtest/gtest.h>

#include <cmath>

#include "io/allocation_watch.hpp"
#include "io/e57_scans.hpp"

namespace hybrid::testing::e57_damage_test {
namespace {

constexpr std::size_t kCount = 3000;
constexpr std::size_t kSection = 48;  // logical, as is the first packet
constexpr std::size_t kPacket = kSection + 32;

io::E57Scan church() {
  io::E57Scan scan{.name = "church"};
  scan.points.fields = {scaled_field("cartesianX", -500'000, 500'000, 1e-4),
                        scaled_field("cartesianY", -500'000, 500'000, 1e-4),
                        scaled_field("cartesianZ", -500'000, 500'000, 1e-4),
                        integer_field("intensity", 0, 4095)};
  return scan;
}

// Two scans and a picture.
std::string good_file(const TemporaryFolder& folder) {
  const auto file = folder.path() / "good.e57";
  io::E57Writer writer(file, {.records_per_packet = 400});
  for (int i = 0; i < 2; ++i) {
    writer.begin_scan(church());
    writer.write(random_columns(church().points.fields, kCount).records());
    writer.end_scan();
  }
  writer.add_image({.name = "north", .width = 1, .height = 1}, std::string(3000, 'p'));
  writer.close();
  return bytes_of(file);
}

// Reads all there is. Points of every scan that are returns.
std::size_t read_all(const std::filesystem::path& file, bool salvage) {
  std::size_t returns = 0;
  for (const Scan& scan : io::read_e57(file, {.salvage = salvage}))
    for (const auto& point : scan.points) returns += std::isfinite(point[0]);
  const io::E57File pictures(file, {.salvage = salvage});
  for (const io::E57Image& image : pictures.contents().images) pictures.read_blob(image.picture, "picture");
  return returns;
}

TEST(E57Damage, EveryPageIsChecked) {
  const TemporaryFolder folder;
  const std::string good = good_file(folder);
  EXPECT_EQ(read_all(folder.path() / "good.e57", false), 2 * kCount);
  for (std::size_t page = 0; page < good.size() / 1024; ++page)
    for (const std::size_t at : {std::size_t{100}, std::size_t{1023}}) {
      std::string bytes = good;
      bytes[1024 * page + at] ^= 4;
      const auto file = folder.write("bad.e57", bytes);
      const std::string message = error_of(ErrorKind::input, [&] { read_all(file, false); });
      EXPECT_TRUE(
          holds(message, fmt::format("bad.e57: byte {} (page {}): expected checksum", 1024 * page, page)));
      EXPECT_TRUE(holds(message, "--salvage"));
    }
}

TEST(E57Damage, CutAtEveryPageAndInside) {
  const TemporaryFolder folder;
  const std::string good = good_file(folder);
  for (std::size_t length = 0; length < good.size(); length += 512) {
    const auto file = folder.write("cut.e57", good.substr(0, length));
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_all(file, false); }), "cut.e57"));
    try {  // the description is at the end: without it there is nothing to salvage
      EXPECT_LE(read_all(file, true), 2 * kCount);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    }
  }
}

struct Lie {
  std::size_t at;  // logical
  std::string by;
  const char* message;
};

TEST(E57Damage, HeadersThatLieTakeNoMemory) {
  const TemporaryFolder folder;
  const std::string good = good_file(folder);
  const std::uint64_t huge = 1ull << 60, odd = 1022;
  const auto word = [](int value) { return little_endian(static_cast<std::uint16_t>(value)); };
  const std::vector<Lie> lies = {
      {0, "ASTM-F57", "signature"},
      {8, little_endian(std::uint32_t{2}), "version 1"},
      {16, little_endian(huge), "byte 16: expected a file of"},
      {24, little_endian(huge), "the XML section: expected an offset"},
      {24, little_endian(odd), "checksum lies"},
      {32, little_endian(huge), "byte 32: expected an XML section"},
      {32, little_endian(std::uint64_t{0}), "byte 32: expected an XML section"},
      {40, little_endian(std::uint64_t{512}), "byte 40: expected pages"},
      {kSection, "\x02", "expected a section of points (1), found 2"},
      {kSection + 8, little_endian(huge), "expected a section of 32 to"},
      {kSection + 8, little_endian(std::uint64_t{31}), "expected a section of 32 to"},
      {kSection + 16, little_endian(huge), "its first packet: expected an offset"},
      {kSection + 16, little_endian(std::uint64_t{48}), "with its first packet inside"},
      {kPacket, "\x03", "expected a packet"},
      {kPacket + 2, word(0xfffb), "expected a packet"},
      {kPacket + 2, word(3), "bytes for its streams"},
      {kPacket + 4, word(5), "expected a packet of 4 streams"},
      {kPacket + 6, word(60000), "bytes for its streams"},
      {kPacket + 6, word(400), "bytes for its streams"},
  };
  for (const Lie& lie : lies) {
    SCOPED_TRACE(lie.message);
    const auto file = folder.write("lie.e57", overwritten(good, lie.at, lie.by));
    const AllocationWatch watch;
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_all(file, false); }), lie.message));
    try {
      read_all(file, true);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    }
    EXPECT_LT(watch.largest_bytes(), 4u << 20);
  }
}

struct XmlLie {
  std::string from, to, message;
};

TEST(E57Damage, DescriptionsThatMakeNoSense) {
  const TemporaryFolder folder;
  const std::string good = good_file(folder);
  std::string deep, bomb = "<!DOCTYPE e57Root [<!ENTITY a \"aaaaaaaaaa\">";
  for (int i = 0; i < 50'000; ++i) deep += "<a>";
  for (char c = 'b'; c < 'z'; ++c)
    bomb += fmt::format("<!ENTITY {} \"&{};&{};&{};\">", c, c - 1, c - 1, c - 1);
  const std::string x = "<cartesianX type=\"ScaledInteger\" minimum=\"-500000\" maximum=\"500000\"";
  const std::vector<XmlLie> lies = {
      {"</e57Root>", "", "well-formed XML"},
      {"<data3D", "<data3D <", "well-formed XML"},
      {"<e57Root", bomb + "]><e57Root", "document type"},
      {"<data3D", deep + "<data3D", "well-formed XML"},
      {"e57Root type", "root type", "well-formed XML"},
      {"recordCount=\"3000\"", "recordCount=\"3100\"", "expected 3100 points, found 30"},
      {"recordCount=\"3000\"", "recordCount=\"2900\"", "expected 2900 points, found 30"},
      {"recordCount=\"3000\"", "recordCount=\"-1\"", "recordCount as a whole number"},
      {"recordCount=\"3000\"", "recordCount=\"1e300\"", "recordCount as a whole number"},
      {"recordCount=\"3000\"", "recordCount=\"99999999999999999999\"", "recordCount as a whole number"},
      {"recordCount=\"3000\"", "recordCount=\"18446744073709551615\"",
       "expected 18446744073709551615 points"},
      {"fileOffset=\"48\"", "fileOffset=\"47\"", "expected an offset"},
      {"fileOffset=\"48\"", "fileOffset=\"99999999\"", "expected an offset"},
      {"type=\"CompressedVector\"", "type=\"Vector\"", "CompressedVector"},
      {x, "<cartesianX type=\"Matrix\"", "Integer, ScaledInteger, Float or String"},
      {x, "<cartesianX type=\"ScaledInteger\" minimum=\"1\" maximum=\"0\"", "minimum of at most"},
      {x, "<cartesianX type=\"ScaledInteger\" minimum=\"one\" maximum=\"0\"", "minimum as a whole number"},
      {x, "<cartesianX type=\"ScaledInteger\"", "found 9"},  // 64 bits: the stream holds fewer
      {x + " scale=\"0.0001\"", x + " scale=\"0\"", "scale"},
      {x + " scale=\"0.0001\"", x + " scale=\"inf\"", "scale"},
      {x + " scale=\"0.0001\"", x + " scale=\"1e20\"", "expected a coordinate within"},
      {"<prototype type=\"Structure\">",
       "<prototype type=\"Structure\"><cartesianX type=\"Integer\" minimum=\"0\"/>", "each field once"},
      {"<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\">",
       "<codecs type=\"Vector\"><vectorChild type=\"zip\"/>", "another codec"},
      {"<points", "<pose><rotation><w>0</w></rotation></pose><points", "rotation other than zero"},
      {"<points", "<pose><translation><x>nan</x></translation></pose><points", "finite translation"},
      {"<imageWidth type=\"Integer\">1", "<imageWidth type=\"Integer\">-1", "pixels"},
      {"<jpegImage ", "<jpegPicture ", "jpegImage or pngImage"},
      {"length=\"3000\"", "length=\"3001\"", "expected a blob section"},
      {"length=\"3000\"", "length=\"9000000000000000000\"", "expected a blob section"},
  };
  for (const XmlLie& lie : lies) {
    SCOPED_TRACE(lie.to.substr(0, 80));
    const auto file = folder.write("lie.e57", with_xml(good, lie.from, lie.to));
    const AllocationWatch watch;
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_all(file, false); }), lie.message));
    try {
      read_all(file, true);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    }
    EXPECT_LT(watch.largest_bytes(), 16u << 20);
  }
  std::string levels, ends;
  for (int i = 0; i < 5000; ++i) {
    levels += "<a>";
    ends += "</a>";
  }
  const auto nested = folder.write("deep.e57", with_xml(good, "<data3D", levels + ends + "<data3D"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_all(nested, false); }), "nested"));
}

// Fields without a bit may be any number of times in a file: the count alone must not take memory.
TEST(E57Damage, PointsWithoutABitAreBounded) {
  const TemporaryFolder folder;
  io::E57Scan scan;
  scan.points.fields = {integer_field("cartesianX", 7, 7), integer_field("cartesianY", 8, 8),
                        scaled_field("cartesianZ", 9, 9, 0.5)};
  const auto file = folder.path() / "same.e57";
  write_e57(file, scan, random_columns(scan.points.fields, 5));
  const Scan five = io::read_e57(file).at(0);
  ASSERT_EQ(five.points.size(), 5u);
  EXPECT_EQ(five.points[4], (std::array<float, 3>{7, 8, 4.5f}));
  const auto huge = folder.write(
      "huge.e57", with_xml(bytes_of(file), "recordCount=\"5\"", "recordCount=\"9000000000000\""));
  const AllocationWatch watch;
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::read_e57(huge); }), "without a stored byte"));
  EXPECT_LT(watch.largest_bytes(), 4u << 20);
}

}  // namespace
}  // namespace hybrid::testing::e57_damage_test
