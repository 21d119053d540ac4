#include "io/las/las_records.hpp"

#include <gtest/gtest.h>

#include "io/e57_scans.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/las/las_header.hpp"
#include "io/las_samples.hpp"
#include "io/read_scan.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

std::size_t slot(const io::E57Table& table, const std::string& name) {
  for (std::size_t k = 0; k < table.fields.size(); ++k)
    if (table.fields[k].name == name) return k;
  ADD_FAILURE() << "no field " << name;
  return 0;
}

bool has(const io::E57Table& table, const std::string& name) {
  return std::ranges::any_of(table.fields, [&](const auto& field) { return field.name == name; });
}

// A file of `format` with `count` records of random bytes, and `extra` bytes more in each.
std::string random_las(int format, std::size_t count, std::size_t extra, std::vector<std::string>& records) {
  std::string file = las_sample(4);
  file.resize(file.size() - 4 * 36);
  const std::size_t bytes = static_cast<std::size_t>(io::las_point_format(format).bytes) + extra;
  file[104] = static_cast<char>(format);
  file.replace(105, 2, raw(static_cast<std::uint16_t>(bytes)));
  file.replace(247, 8, raw(std::uint64_t{count}));
  std::mt19937 random(static_cast<unsigned>(format) + 1);
  records.clear();
  for (std::size_t i = 0; i < count; ++i) {
    std::string& record = records.emplace_back(bytes, '\0');
    for (char& c : record) c = static_cast<char>(random());
    // Within 300 m, as coordinates in 125 mm steps farther off than anyone scans would be refused.
    for (std::size_t axis = 0; axis < 3; ++axis)
      record.replace(4 * axis, 4, raw(static_cast<std::int32_t>(random() % 4001) - 2000));
    file += record;
  }
  return file;
}

std::uint64_t word(const std::string& record, std::size_t at, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    value |= std::uint64_t{static_cast<unsigned char>(record[at + i])} << (8 * i);
  return value;
}

// A field of each point format and the bits that LAS 1.4 gives it.
struct Bits {
  const char* name;
  std::size_t at, bytes;
  int shift, bits;
};
const std::vector<Bits> kOld = {{"las:returnNumber", 14, 1, 0, 3},   {"las:numberOfReturns", 14, 1, 3, 3},
                                {"las:scanDirection", 14, 1, 6, 1},  {"las:edgeOfFlightLine", 14, 1, 7, 1},
                                {"las:classification", 15, 1, 0, 5}, {"las:classificationFlags", 15, 1, 5, 3},
                                {"las:userData", 17, 1, 0, 8},       {"las:pointSource", 18, 2, 0, 16}};
const std::vector<Bits> kNew = {
    {"las:returnNumber", 14, 1, 0, 4},        {"las:numberOfReturns", 14, 1, 4, 4},
    {"las:classificationFlags", 15, 1, 0, 4}, {"las:scannerChannel", 15, 1, 4, 2},
    {"las:scanDirection", 15, 1, 6, 1},       {"las:edgeOfFlightLine", 15, 1, 7, 1},
    {"las:classification", 16, 1, 0, 8},      {"las:userData", 17, 1, 0, 8},
    {"las:pointSource", 20, 2, 0, 16}};

}  // namespace

TEST(LasRecords, EveryBitOfEveryPointFormatIsInTheE57File) {
  const ScanFolder folder;
  const auto out = folder.path("out.e57");
  for (int format = 0; format < io::kLasPointFormats; ++format) {
    SCOPED_TRACE(format);
    const auto& layout = io::las_point_format(format);
    std::vector<std::string> records;
    const auto file = folder.write("a.las", random_las(format, 5000, format % 2 == 0 ? 3 : 0, records));
    const io::LasAsE57 source(file);
    std::vector<std::string> dropped;
    if (layout.waveform > 0) dropped.emplace_back("waveforms");
    if (format % 2 == 0) dropped.emplace_back("extra bytes of the points");
    EXPECT_EQ(source.dropped(), dropped);
    io::copy_e57(source, out);
    const io::E57File read(out);
    const io::E57Table& table = read.contents().scans.at(0).points;
    const E57Columns columns = read_columns(read, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(table.fields[axis].type, io::E57Type::scaled_integer);
      EXPECT_EQ(table.fields[axis].scale, 0.125);
      EXPECT_EQ(table.fields[axis].offset, axis == 0 ? -1 : 0);
    }
    std::vector<Bits> fields = layout.extended ? kNew : kOld;
    fields.push_back({"intensity", 12, 2, 0, 16});
    if (layout.red > 0)
      for (std::size_t k = 0; k < 3; ++k)
        fields.push_back({k == 0   ? "colorRed"
                          : k == 1 ? "colorGreen"
                                   : "colorBlue",
                          static_cast<std::size_t>(layout.red) + 2 * k, 2, 0, 16});
    if (layout.infrared > 0)
      fields.push_back({"las:nearInfrared", static_cast<std::size_t>(layout.infrared), 2, 0, 16});
    for (const Bits& bits : fields) {
      const auto& found = columns.integers[slot(table, bits.name)];
      ASSERT_EQ(found.size(), records.size()) << bits.name;
      for (std::size_t i = 0; i < records.size(); ++i)
        ASSERT_EQ(static_cast<std::uint64_t>(found[i]),
                  word(records[i], bits.at, bits.bytes) >> bits.shift & ((1u << bits.bits) - 1))
            << bits.name << " " << i;
    }
    for (std::size_t i = 0; i < records.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_EQ(columns.integers[axis][i], static_cast<std::int32_t>(word(records[i], 4 * axis, 4)));
      const std::int64_t angle = layout.extended ? static_cast<std::int16_t>(word(records[i], 18, 2))
                                                 : static_cast<std::int8_t>(word(records[i], 16, 1));
      ASSERT_EQ(columns.integers[slot(table, "las:scanAngle")][i], angle);
      if (layout.gps_time > 0) {
        const std::uint64_t bits = word(records[i], static_cast<std::size_t>(layout.gps_time), 8);
        const double time = columns.reals[slot(table, "las:gpsTime")][i];
        ASSERT_EQ(std::memcmp(&time, &bits, 8), 0);
      }
    }
  }
}

TEST(LasRecords, TheScanIsTheSameAndRangeImagesKeepIt) {
  const ScanFolder folder;
  const auto file = folder.write("a.las", las_sample(4)), direct = folder.path("direct.e57"),
             image = folder.path("a.exr"), back = folder.path("back.e57");
  const io::LasAsE57 source(file);
  EXPECT_FALSE(has(source.contents().scans[0].points, "las:gpsTime")) << "no record has one";
  io::copy_e57(source, direct);
  io::write_exr_scan(source, 0, image, {});
  io::copy_e57(io::ExrSource({image}), back);
  EXPECT_TRUE(bytes_of(direct) == bytes_of(back));
  const Scan las = io::read_scan(file, 0);
  for (const auto& other : {direct, image}) {
    const Scan scan = io::read_scan(other, 0);
    ASSERT_EQ(scan.points.size(), 4u);
    EXPECT_TRUE(scan.points == las.points && scan.intensity == las.intensity && scan.rgb == las.rgb);
    EXPECT_EQ(scan.intensity_limits, las.intensity_limits);
    EXPECT_EQ(scan.crs, las.crs);
  }
}

TEST(LasRecords, NoPointsAndBadFiles) {
  const ScanFolder folder;
  const auto out = folder.path("out.e57");
  std::vector<std::string> records;
  io::copy_e57(io::LasAsE57(folder.write("none.las", random_las(6, 0, 0, records))), out);
  EXPECT_EQ(io::E57File(out).contents().scans.at(0).points.count, 0u);
  const std::string good = random_las(6, 10, 0, records);
  expect_input_error([&] { io::LasAsE57(folder.write("short.las", good.substr(0, good.size() - 1))); },
                     {"short.las"});
  expect_input_error([&] { io::LasAsE57(folder.write("long.las", good + std::string(30, 'x'))); },
                     {"long.las", "correct the count"});
}

}  // namespace hybrid::testing
