// Range images that are none, or damaged: the error names the channel or attribute and what to do.
#include <ImfVecAttribute.h>
#include <gtest/gtest.h>

#include "io/exr/exr_scan.hpp"
#include "io/exr/range_exr.hpp"
#include "io/foreign_exr.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::exr_scan_damage_test {
namespace {

constexpr const char* kElevation = "hybrid:elevation_rad";
constexpr const char* kAzimuth = "hybrid:azimuth_rad";
constexpr const char* kPose = "hybrid:world_from_scan";

class ExrScanDamage : public ::testing::Test {
 protected:
  // 3 columns, 2 rows of ranges with their tables, then changed.
  template <typename Change>
  void expect_refused(const Change& change, const std::vector<std::string>& parts) {
    ForeignExr exr(3, 2);
    exr.add("range", Imf::FLOAT);
    exr.attribute(kElevation, std::string("0.1 0"));
    exr.attribute(kAzimuth, std::string("0 0.1 0.2"));
    change(exr);
    const auto file = folder_.path("west wall.exr");
    exr.write(file);
    std::vector<std::string> all{file.string() + ": "};
    all.insert(all.end(), parts.begin(), parts.end());
    expect_input_error([&] { io::read_exr_scan(file); }, all);
  }
  void expect_refused_bytes(const std::string& bytes, const std::vector<std::string>& parts) {
    const auto file = folder_.write("damaged.exr", bytes);
    std::vector<std::string> all{file.string() + ": "};
    all.insert(all.end(), parts.begin(), parts.end());
    expect_input_error([&] { io::read_exr_scan(file); }, all);
  }
  void points(ForeignExr& exr, Imf::PixelType type) const {
    for (const char* name : {"x", "y", "z"}) exr.add(name, type);
  }
  ScanFolder folder_;
};

TEST_F(ExrScanDamage, ChannelsThatAreMissingOrOfAnotherKind) {
  ForeignExr colours(3, 2);
  for (const char* name : {"R", "G", "B"}) colours.add(name, Imf::HALF);
  colours.write(folder_.path("photo.exr"));
  expect_input_error([&] { io::read_exr_scan(folder_.path("photo.exr")); },
                     {"header: expected the channel range", "x y z", "found no such channel"});
  ForeignExr flat(3, 2);
  flat.add("x", Imf::FLOAT);
  flat.add("z", Imf::FLOAT);
  flat.write(folder_.path("flat.exr"));
  expect_input_error([&] { io::read_exr_scan(folder_.path("flat.exr")); }, {"x y z", "found no y"});
  expect_refused([&](ForeignExr& exr) { points(exr, Imf::HALF); },
                 {"channel x", "found half", "4 mm at 8 m", "write it as float"});
  expect_refused([&](ForeignExr& exr) { points(exr, Imf::UINT); }, {"channel x", "found uint"});
  expect_refused([&](ForeignExr& exr) { exr.add("mask", Imf::FLOAT); },
                 {"channel mask: expected uint, found float", "leave it out"});
  expect_refused(
      [](ForeignExr& exr) {
        exr.add("mask", Imf::UINT);
        exr.channel("mask")[4] = 255;
      },
      {"channel mask: row 1, column 1", "found 255", "or no mask"});
}

TEST_F(ExrScanDamage, Attributes) {
  const auto set = [](const char* name, const std::string& value) {
    return [=](ForeignExr& exr) { exr.attribute(name, value); };
  };
  expect_refused([](ForeignExr& exr) { exr.attributes().erase(kElevation); },
                 {kElevation, "hybrid:elevation_first_rad", "without x y z", "write the 2 angles"});
  expect_refused([](ForeignExr& exr) { exr.attributes().erase(kAzimuth); }, {kAzimuth, "the 3 angles"});
  expect_refused(set(kElevation, "0.1 0 -0.1"), {kElevation, "expected 2 angles, found 3"});
  expect_refused(set(kElevation, "0.1 up"), {kElevation, "expected a number", "up"});
  expect_refused(set(kAzimuth, "0 nan 1"), {kAzimuth, "angle 1", "nan"});
  expect_refused(set(kAzimuth, "0 90 180"), {kAzimuth, "radians", "90", "degrees"});
  expect_refused(
      [](ForeignExr& exr) {
        exr.attributes().erase(kAzimuth);
        exr.attributes().insert(kAzimuth, Imf::V3fAttribute({0, 1, 2}));
      },
      {kAzimuth, "v3f", "write it as text"});
  expect_refused(
      [](ForeignExr& exr) {
        exr.attributes().erase(kElevation);
        exr.attribute("hybrid:elevation_first_rad", 0.1);
      },
      {"found no hybrid:elevation_step_rad"});
  expect_refused(set(kPose, "1 0 0 0"), {kPose, "expected 16 numbers", "found 4"});
  expect_refused(set(kPose, "1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"), {kPose, "finite", "nan", "register"});
  expect_refused(set(kPose, "1 0 0 0 0 2 0 0 0 0 3 0 0 0 0 1"), {kPose, "not a rotation"});
  expect_refused([](ForeignExr& exr) { exr.attribute("hybrid:wraps", 0.5); },
                 {"hybrid:wraps", "whole number", "0.5"});
}

TEST_F(ExrScanDamage, LayoutsOfOtherFiles) {
  expect_refused_bytes("", {"empty"});
  expect_refused_bytes("ply\n", {"byte 0: expected an OpenEXR file"});
  ForeignExr exr(3, 2);
  points(exr, Imf::FLOAT);
  exr.write(folder_.path("good.exr"));
  std::string bytes = bytes_of(folder_.path("good.exr"));
  bytes[5] = 0x08;
  expect_refused_bytes(bytes, {"byte 4: expected a flat image, found deep samples", "as a flat one"});
  bytes[5] = 0x10;
  expect_refused_bytes(bytes, {"data window of at least 1 x 1"});  // several parts' headers: another follows
  ForeignExr large(3, 2);
  points(large, Imf::FLOAT);
  large.tile = 1100;
  large.write(folder_.path("large.exr"));
  expect_refused_bytes(bytes_of(folder_.path("large.exr")), {"at most 1024 pixels a side", "1100 x 1100"});
}

TEST_F(ExrScanDamage, EveryCutIsFound) {
  for (const int tile : {0, 64}) {
    ForeignExr exr(200, 150);
    exr.tile = tile;
    points(exr, Imf::FLOAT);
    exr.write(folder_.path("good.exr"));
    const std::string good = bytes_of(folder_.path("good.exr"));
    for (std::size_t size = 1; size < 600; size += 11)
      expect_refused_bytes(good.substr(0, size), {"expected"});
    for (std::size_t i = 1; i <= 40; ++i)
      expect_refused_bytes(good.substr(0, i * (good.size() - 1) / 40), {"expected"});
  }
}

TEST_F(ExrScanDamage, AWindowThatTheFileCannotHold) {
  ForeignExr exr(3, 2);
  points(exr, Imf::FLOAT);
  exr.write(folder_.path("good.exr"));
  std::string bytes = bytes_of(folder_.path("good.exr"));
  const std::size_t window = bytes.find("dataWindow") + 11 + 6 + 4;
  bytes.replace(window + 8, 8, raw(2) + raw(2'000'000'000));
  expect_refused_bytes(bytes, {"blocks of lines"});
  bytes.replace(window + 8, 8, raw(2) + raw(-1));
  expect_refused_bytes(bytes, {"data window of at least 1 x 1"});
}

// Uncompressed samples have no other check.
TEST_F(ExrScanDamage, FlippedBytesOfOurOwnFileAreFound) {
  RangeImage image = make_range_image(300, 290);
  for (std::size_t i = 0; i < image.count(); ++i) {
    image.mask[i] = kMeasured;
    image.x[i] = image.y[i] = image.z[i] = image.range_m[i] = 1 + static_cast<float>(i % 1009) / 1000;
  }
  io::write_range_exr(folder_.path("range.exr"), image, {});
  const std::string good = bytes_of(folder_.path("range.exr"));
  const auto intact = io::read_exr_scan(folder_.path("range.exr")).points;
  const std::size_t header = good.size() / 5;
  int found = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    std::string bytes = good;
    char& byte = bytes[header + i * (bytes.size() - header - 1) / 39];
    byte = static_cast<char>(byte ^ 0x10);
    const auto file = folder_.write("flipped.exr", bytes);
    try {
      EXPECT_EQ(io::read_exr_scan(file).points, intact) << i;  // a bit that means nothing
    } catch (const Error& error) {
      ++found;
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    }
  }
  EXPECT_GE(found, 36);
}

}  // namespace
}  // namespace hybrid::testing::exr_scan_damage_test
