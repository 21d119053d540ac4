// Range images of which tiles or lines are damaged or missing: the others are used.
#include <gtest/gtest.h>

#include <cmath>

#include "io/exr/exr_scan.hpp"
#include "io/foreign_exr.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::exr_salvage_test {
namespace {

constexpr int kWidth = 150, kHeight = 130;

class ExrSalvage : public ::testing::Test {
 protected:
  static ForeignExr image(int tile) {
    ForeignExr exr(kWidth, kHeight);
    exr.tile = tile;
    for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
    return exr;
  }
  std::string bytes(const ForeignExr& exr) const {
    exr.write(folder_.path("good.exr"));
    return bytes_of(folder_.path("good.exr"));
  }
  // Strictly refused; with salvage right where it is there.
  Scan salvage(const std::string& damaged, const std::vector<std::string>& error) const {
    const auto file = folder_.write("bad.exr", damaged);
    std::vector<std::string> all = error;
    all.push_back(file.string() + ": ");
    expect_input_error([&] { io::read_exr_scan(file); }, all);
    return io::read_exr_scan(file, {.salvage = true});
  }
  // Nodes that are there, each with the value that was written.
  static std::size_t right_nodes(const Scan& scan, ForeignExr& exr) {
    std::size_t right = 0;
    EXPECT_EQ(scan.points.size(), static_cast<std::size_t>(kWidth * kHeight));
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (!std::isfinite(scan.points[i][0])) continue;
      EXPECT_EQ(scan.points[i][0], exr.channel("x")[i]) << i;
      EXPECT_EQ(scan.points[i][2], exr.channel("z")[i]) << i;
      ++right;
    }
    return right;
  }
  static std::string all(const Scan& scan) { return fmt::format("{}", fmt::join(scan.notes, "\n")); }

  ScanFolder folder_;
};

TEST_F(ExrSalvage, ADamagedTileCostsOnlyItself) {
  ForeignExr exr = image(64);
  std::string file = bytes(exr);
  file.replace(file.size() / 2, 200, std::string(200, '\x55'));  // within one of 3 x 3
  const Scan scan = salvage(file, {"damaged file"});
  const std::size_t right = right_nodes(scan, exr);
  EXPECT_GE(right, static_cast<std::size_t>(kWidth * kHeight - 2 * 64 * 64));
  EXPECT_LT(right, static_cast<std::size_t>(kWidth * kHeight));
  EXPECT_TRUE(holds(all(scan), fmt::format("{} of {} points (", kWidth * kHeight - right, kWidth * kHeight)));
  EXPECT_TRUE(holds(all(scan), "columns "));
}

TEST_F(ExrSalvage, ADamagedBlockOfLinesCostsOnlyItself) {
  ForeignExr exr = image(0);
  std::string file = bytes(exr);
  file.replace(file.size() / 2, 200, std::string(200, '\x55'));
  const Scan scan = salvage(file, {"damaged file"});
  EXPECT_GE(right_nodes(scan, exr), static_cast<std::size_t>(kWidth * (kHeight - 3 * 16)));
  EXPECT_TRUE(holds(all(scan), "are lost to damage, the first by: rows "));
}

TEST_F(ExrSalvage, WhatIsCutOffIsLost) {
  for (const int tile : {0, 64}) {
    SCOPED_TRACE(tile);
    ForeignExr exr = image(tile);
    const std::string file = bytes(exr);
    const Scan scan = salvage(file.substr(0, file.size() * 2 / 3), {"end of file", "use --salvage"});
    const std::size_t right = right_nodes(scan, exr);
    EXPECT_GE(right, static_cast<std::size_t>(kWidth * kHeight * 4 / 10));
    EXPECT_LE(right, static_cast<std::size_t>(kWidth * kHeight * 7 / 10));
    EXPECT_TRUE(holds(all(scan), fmt::format("of {} points (", kWidth * kHeight)));
  }
}

TEST_F(ExrSalvage, ValuesThatMakeNoSense) {
  ForeignExr exr = image(0);
  exr.add("mask", Imf::UINT);
  for (float& value : exr.channel("mask")) value = 1;
  exr.channel("mask")[7] = 200;
  const Scan states = salvage(bytes(exr), {"channel mask", "found 200"});
  EXPECT_EQ(right_nodes(states, exr), static_cast<std::size_t>(kWidth * kHeight - 1));
  ForeignExr far = image(0);
  far.channel("x")[9] = 1e20f;
  far.attribute("hybrid:world_from_scan", std::string("1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"));
  const Scan scan = salvage(bytes(far), {"hybrid:world_from_scan"});
  EXPECT_EQ(right_nodes(scan, far), static_cast<std::size_t>(kWidth * kHeight - 1));
  EXPECT_FALSE(scan.world_from_scan);
  EXPECT_TRUE(holds(all(scan), "row 0, column 9: expected a coordinate within 1000000000000 m"));
  EXPECT_TRUE(holds(all(scan), "1 nodes have absurd coordinates"));
  EXPECT_TRUE(holds(all(scan), "hybrid:world_from_scan"));
}

// Sizes that the library would believe: found by fuzzing.
TEST_F(ExrSalvage, AttributesWhoseSizeIsNotThatOfTheirType) {
  ForeignExr exr = image(0);
  exr.attribute("hybrid:wraps", 1.0);
  std::string file = bytes(exr);
  const std::string size = std::string("double") + '\0' + raw(8);
  const std::size_t at = file.find(size);
  ASSERT_NE(at, file.npos);
  file[at + 7] = 7;
  const auto bad = folder_.write("bad.exr", file);
  for (const bool salvaging : {false, true})
    expect_input_error([&] { io::read_exr_scan(bad, {.salvage = salvaging}); },
                       {"\"hybrid:wraps\" of type \"double\" to have 8 bytes, found 7"});
}

}  // namespace
}  // namespace hybrid::testing::exr_salvage_test
