#include <gtest/gtest.h>

#include <cmath>

#include "io/e57_scans.hpp"

namespace hybrid::testing::e57_salvage_test {
namespace {

constexpr std::size_t kCount = 40'000;
constexpr std::size_t kRecord_bits = 90, kPerPacket = 4000;

io::E57Scan hall() {
  io::E57Scan scan{.name = "hall"};
  const std::int64_t half = 1 << 19;
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back(scaled_field(name, -half, half - 1, 1e-3));
  scan.points.fields.push_back(integer_field("intensity", 0, 4095));
  scan.points.fields.push_back(integer_field("rowIndex", 0, 511));
  scan.points.fields.push_back(integer_field("columnIndex", 0, 511));
  return scan;
}

class E57Salvage : public ::testing::Test {
 protected:
  E57Salvage() : good_(random_columns(hall().points.fields, kCount)) {
    const auto file = folder_.path() / "hall.e57";
    write_e57(file, hall(), good_, {.records_per_packet = kPerPacket});
    bytes_ = bytes_of(file);
  }

  // Returns whose value is as written; fails when one is not.
  std::size_t right_points(const Scan& scan) const {
    std::size_t right = 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (!std::isfinite(scan.points[i][0])) continue;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(scan.points[i][k], static_cast<float>(static_cast<double>(good_.integers[k][i]) * 1e-3))
            << i;
      ++right;
    }
    return right;
  }
  Scan salvage(const std::string& bytes) const {
    const auto file = folder_.write("damaged.e57", bytes);
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::read_e57(file); }), "damaged.e57: "));
    return io::read_e57(file, {.salvage = true}).at(0);
  }
  static std::string all(const Scan& scan) {
    std::string text;
    for (const std::string& note : scan.notes) text += note + "\n";
    return text;
  }
  std::string zeroed(std::size_t page, std::size_t count = 1) const {
    std::string bytes = bytes_;
    return bytes.replace(1024 * page, 1024 * count, std::string(1024 * count, '\0'));
  }
  // Of packet `p`, where its header lies.
  static std::size_t page_of_packet(std::size_t p) {
    return (48 + 32 + p * (6 + 12 + kPerPacket * kRecord_bits / 8 + 2) / 4 * 4) / 1020;
  }

  TemporaryFolder folder_;
  E57Columns good_;
  std::string bytes_;
};

TEST_F(E57Salvage, APageOfValuesCostsOnlyThem) {
  const Scan scan = salvage(zeroed(page_of_packet(3) + 5));  // within x of the fourth packet
  EXPECT_EQ(scan.points.size(), kCount);
  const std::size_t right = right_points(scan);
  EXPECT_GE(right, kCount - 1020 * 8 / 20 - 2);
  EXPECT_LT(right, kCount - 400);
  EXPECT_TRUE(holds(all(scan), fmt::format("1 damaged pages of 1024 bytes, the first at byte {}",
                                           1024 * (page_of_packet(3) + 5))));
  EXPECT_TRUE(holds(all(scan), fmt::format("{} of 40000 points (", kCount - right)));
  EXPECT_TRUE(holds(all(scan), "lost to damage"));
}

// The lengths in the header that is gone are not known, but where the streams end is.
TEST_F(E57Salvage, AHeaderCostsItsPacketOnly) {
  const Scan scan = salvage(zeroed(page_of_packet(4)));
  EXPECT_EQ(scan.points.size(), kCount);
  const std::size_t right = right_points(scan);
  EXPECT_GE(right, kCount - 2 * kPerPacket);
  EXPECT_LT(right, kCount);
  EXPECT_TRUE(holds(all(scan), "of the points' section) are lost"));
}

TEST_F(E57Salvage, AStretchOfPackets) {
  const std::size_t first = page_of_packet(2), last = page_of_packet(5);
  const Scan scan = salvage(zeroed(first, last - first));
  const std::size_t right = right_points(scan);
  EXPECT_GE(right, kCount - 5 * kPerPacket);
  EXPECT_LE(right, kCount - 3 * kPerPacket);
}

// Two stretches: what lies between them has no place, the rest has.
TEST_F(E57Salvage, TwoHeaders) {
  std::string bytes = zeroed(page_of_packet(2));
  bytes.replace(1024 * page_of_packet(7), 1024, std::string(1024, '\0'));
  const std::size_t right = right_points(salvage(bytes));
  EXPECT_GE(right, 3 * kPerPacket);
  EXPECT_LE(right, 6 * kPerPacket);
}

TEST_F(E57Salvage, ADamagedPageWhoseHeadersStillMakeSense) {
  std::string bytes = bytes_;
  bytes[1024 * page_of_packet(4) + 1023] ^= 1;
  EXPECT_GE(right_points(salvage(bytes)), kCount - 1000);
}

TEST_F(E57Salvage, CountsThatAreWrong) {
  const Scan more = salvage(with_xml(bytes_, "recordCount=\"40000\"", "recordCount=\"50000\""));
  EXPECT_GE(more.points.size(), kCount);
  EXPECT_LE(more.points.size(), kCount + 8);  // what fills up the last word may look like points
  EXPECT_GE(right_points(more), kCount);
  EXPECT_TRUE(holds(all(more), "expected 50000 points, found 4000"));
  EXPECT_TRUE(holds(all(more), "(20.0 %) are lost"));
  const Scan fewer = salvage(with_xml(bytes_, "recordCount=\"40000\"", "recordCount=\"30000\""));
  EXPECT_EQ(fewer.points.size(), 30'000u);
  EXPECT_EQ(right_points(fewer), 30'000u);
  EXPECT_TRUE(holds(all(fewer), "those beyond the count are left out"));
}

TEST_F(E57Salvage, AbsurdCoordinates) {
  io::E57Scan scan;
  scan.points.fields = {real_field("cartesianX"), real_field("cartesianY"), real_field("cartesianZ")};
  E57Columns columns = random_columns(scan.points.fields, 100);
  columns.reals[1][17] = std::ldexp(1.0, 100);
  columns.reals[2][18] = NAN;
  const auto file = folder_.path() / "absurd.e57";
  write_e57(file, scan, columns);
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { io::read_e57(file); }), "point 17: expected a coordinate"));
  const Scan found = io::read_e57(file, {.salvage = true}).at(0);
  EXPECT_TRUE(std::isnan(found.points[17][0]) && std::isnan(found.points[18][0]));
  EXPECT_TRUE(std::isfinite(found.points[16][0]));
  EXPECT_TRUE(holds(all(found), "1 of 100 points have absurd coordinates"));
  EXPECT_TRUE(holds(all(found), "1 of 100 points are not finite"));
}

TEST_F(E57Salvage, OtherScansGoOn) {
  const auto file = folder_.path() / "two.e57";
  io::E57Writer writer(file);
  for (int i = 0; i < 2; ++i) {
    writer.begin_scan(hall());
    writer.write(good_.records());
    writer.end_scan();
  }
  writer.close();
  const auto damaged =
      folder_.write("damaged two.e57", with_xml(bytes_of(file), "fileOffset=\"48\"", "fileOffset=\"49\""));
  error_of(ErrorKind::input, [&] { io::read_e57(damaged); });
  const auto scans = io::read_e57(damaged, {.salvage = true});
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_EQ(scans[0].name, "damaged two-0");
  EXPECT_EQ(right_points(scans[1]), kCount);
}

}  // namespace
}  // namespace hybrid::testing::e57_salvage_test
