// `hybrid convert` between E57 files and range images, which keep records as stored, and from and to the
// other formats; on a real scan where there is one.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "places.hpp"
#include "program.hpp"
#include "small_ptx.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

class ConvertRecords : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  std::string bytes(const fs::path& name) const {
    std::ifstream in(folder_.path() / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  bool same(const std::string& one, const std::string& other) const {
    return fs::exists(folder_ / one) && bytes(one) == bytes(other);
  }
  Outcome hybrid(const std::string& arguments) const {
    return run("cd '" + folder_.path().string() + "' && hybrid " + arguments);
  }
  void expect_done(const std::string& arguments) const {
    const Outcome outcome = hybrid(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << ": " << outcome.err;
  }
  static bool holds(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }
  static fs::path data(const std::string& name) {
    const char* folder = std::getenv("HYBRID_DATA");
    return (folder ? fs::path(folder) : fs::path(HYBRID_PROJECT_DIR) / "../shared/data") / name;
  }

  Scratch folder_;
};

TEST_F(ConvertRecords, ARealScanWithItsPhotographAndLinesOfPoints) {
  const fs::path pump = data("scans/e57-pye57/pumpAVisualReferenceImage.e57");
  if (!fs::exists(pump)) GTEST_SKIP() << pump << " is not there";
  const std::string in = pump.string();  // no blanks in it
  const Outcome made = hybrid("convert " + in + " a.exr --json");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json output = Json::parse(made.out)["outputs"][0];
  EXPECT_EQ(output["parts"], "a.parts");
  EXPECT_EQ(output["scans"][0]["samples"], 155201);
  EXPECT_TRUE(output["scans"][0]["dropped"].empty());
  EXPECT_EQ(fs::file_size(folder_ / "a.parts/jpegImage-2593604.jpg"), 1'504'576u);
  // Back, and directly: the same file, as another copy of it is.
  expect_done("convert a.exr b.e57");
  expect_done("convert " + in + " c.e57");
  EXPECT_TRUE(same("b.e57", "c.e57"));
  expect_done("convert b.e57 d.e57");
  EXPECT_TRUE(same("d.e57", "c.e57"));
  // To others as from the file itself.
  for (const std::string name : {"ptx", "las"}) {
    expect_done("convert a.exr e." + name);
    expect_done("convert " + in + " f." + name);
    EXPECT_TRUE(same("e." + name, "f." + name)) << name;
    const Outcome again = hybrid("convert a.exr e." + name + " --force");
    EXPECT_TRUE(holds(again.err, "photographs (1)")) << again.err;
  }
  const Json image = Json::parse(hybrid("info a.exr --json").out)["scans"][0],
             file = Json::parse(hybrid("info " + in + " --json").out)["scans"][0];
  for (const char* key : {"points", "returns", "rows", "cols", "minimum_m", "maximum_m", "range_m", "notes"})
    EXPECT_EQ(image[key], file[key]) << key;
  EXPECT_TRUE(holds(image["structure"], "cartesianX (whole -8388608 to 8388607, times 1e-06, plus 0)"));
  // What is there is not replaced, the folder included.
  fs::remove(folder_ / "a.exr");
  const Outcome refused = hybrid("convert " + in + " a.exr");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(holds(refused.err, "a.parts: is there already")) << refused.err;
  EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
}

// Everything that is read can be written as E57 and as range images, and comes back.
TEST_F(ConvertRecords, SeveralScansOfTextThroughBoth) {
  const std::string scan = kHeader + "5 6 7 1\n" + kPoints, other = kHeader + "0 0 0 1\n" + kPoints;
  write("a.ptx", scan + other);
  expect_done("convert a.ptx direct.ptx");
  expect_done("convert a.ptx b.e57");
  expect_done("convert b.e57 back.ptx");
  EXPECT_TRUE(same("back.ptx", "direct.ptx"));
  expect_done("convert b.e57 c.exr");
  EXPECT_TRUE(fs::exists(folder_ / "c-0.exr") && fs::exists(folder_ / "c-1.exr"));
  EXPECT_FALSE(fs::exists(folder_ / "c.parts"));
  expect_done("convert c-1.exr c-0.exr d.e57");
  EXPECT_TRUE(same("b.e57", "d.e57"));
  expect_done("convert a.ptx --index 0 e.exr");
  expect_done("convert e.exr e.ptx");
  expect_done("convert a.ptx --index 0 f.ptx");
  EXPECT_TRUE(same("e.ptx", "f.ptx"));
  expect_done("convert e.exr g.exr");
  expect_done("convert e.exr e.e57");
  expect_done("convert g.exr g.e57");
  EXPECT_TRUE(same("e.e57", "g.e57"));
  EXPECT_EQ(Json::parse(hybrid("info e.exr --json").out)["scans"][0]["points"], 4);
  const Outcome told = hybrid("convert b.e57 h.exr --dry-run");
  EXPECT_TRUE(holds(told.out, "would write h-0.exr: records as stored\nwould write h-1.exr")) << told.out;
  EXPECT_FALSE(fs::exists(folder_ / "h-0.exr"));
}

TEST_F(ConvertRecords, WhatIsWrongIsNamed) {
  write("a.ptx", kHeader + "5 6 7 1\n" + kPoints + kHeader + "0 0 0 1\n" + kPoints);
  expect_done("convert a.ptx a.e57");
  expect_done("convert a.ptx b.exr");
  const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
    const Outcome outcome = hybrid("convert " + arguments);
    EXPECT_EQ(outcome.exit_code, code) << arguments;
    EXPECT_TRUE(holds(outcome.err, part)) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "c.e57"));
  };
  refused("b-0.exr b-1.exr c.e57", 4, "found another file's; convert each by itself");
  refused("a.ptx b-1.exr c.pcd", 2, "expected one input");
  refused("b-0.exr b-0.exr c.e57", 4, "found scan 0 again");
  refused("b-0.exr b-1.exr c.ply", 2, "expected one input");
  refused("a.e57 b.exr", 2, "b-0.exr: is there already");
  refused("a.e57 a.e57", 2, "is the input itself");
  refused("a.e57 c.e57 --index 2", 4, "the file holds 2 scans");
  refused("b-0.exr", 2, "At least 2 required");
  // A page of the second scan: the first goes on; in salvage the samples of both.
  std::string damaged = bytes("a.e57");
  const std::size_t at = damaged.find("<?xml") - 40;
  damaged[at] = static_cast<char>(damaged[at] ^ 1);
  write("damaged.e57", damaged);
  refused("damaged.e57 c.e57", 4, "byte 0 (page 0)");
  EXPECT_EQ(hybrid("convert damaged.e57 saved.e57 --salvage").exit_code, 0);
  EXPECT_EQ(Json::parse(hybrid("info saved.e57 --json").out)["scans"].size(), 2u);
}

TEST_F(ConvertRecords, ADamagedScanDoesNotStopTheOthers) {
  std::string text;
  for (int scan = 0; scan < 3; ++scan) {
    text += "20\n30\n" + kHeader.substr(4) + "0 0 0 1\n";
    for (int i = 0; i < 600; ++i) text += std::to_string(i) + ".5 2 3 0.25\n";
  }
  write("a.ptx", text);
  expect_done("convert a.ptx a.e57");
  std::string damaged = bytes("a.e57");  // three scans of 13 KB and the description
  damaged[20'000] = static_cast<char>(damaged[20'000] ^ 1);
  write("b.e57", damaged);
  for (const std::string out : {"c.e57", "c.exr"}) {
    const Outcome outcome = hybrid("convert b.e57 " + out);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_TRUE(holds(outcome.err, "scan b-1") && holds(outcome.err, "(page 19)")) << outcome.err;
  }
  expect_done("convert c-2.exr c-0.exr d.e57");
  EXPECT_TRUE(same("c.e57", "d.e57"));
  EXPECT_EQ(Json::parse(hybrid("info d.e57 --json").out)["scans"].size(), 2u);
  EXPECT_FALSE(fs::exists(folder_ / "c-1.exr"));
  // With --salvage its records that are left, as they are stored; by way of range images, too.
  const Outcome saved = hybrid("convert b.e57 e.e57 --salvage --json");
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  const Json scans = Json::parse(saved.out)["outputs"][0]["scans"];
  ASSERT_EQ(scans.size(), 3u);
  EXPECT_EQ(scans[0]["samples"], 600);
  EXPECT_TRUE(scans[0]["notes"].empty());
  const auto left = scans[1]["samples"].get<int>();
  EXPECT_TRUE(left > 0 && left < 600) << left;
  EXPECT_EQ(scans[1]["records"], "as stored");
  EXPECT_TRUE(holds(scans[1]["notes"].dump(), "the first at byte 19456")) << scans[1]["notes"];
  EXPECT_TRUE(holds(saved.err, "of 600 points")) << saved.err;
  expect_done("convert b.e57 f.exr --salvage");
  expect_done("convert f-0.exr f-1.exr f-2.exr g.e57");
  EXPECT_TRUE(same("e.e57", "g.e57"));
  const Json info = Json::parse(hybrid("info g.e57 --json").out)["scans"][1];
  EXPECT_EQ(info["points"], left);
  EXPECT_FALSE(info.contains("damage")) << info;
}

// A description with a damaged page cannot be trusted with what it says of records: samples, then.
TEST_F(ConvertRecords, ADamagedDescription) {
  write("a.ptx", kHeader + "0 0 0 1\n" + kPoints);
  expect_done("convert a.ptx a.e57");
  std::string damaged = bytes("a.e57");
  const std::size_t at = damaged.find("<guid") + 40;
  damaged[at] = static_cast<char>(damaged[at] ^ 1);
  write("b.e57", damaged);
  EXPECT_EQ(hybrid("convert b.e57 c.e57").exit_code, 4);
  const Outcome saved = hybrid("convert b.e57 c.e57 --salvage --json");
  EXPECT_EQ(saved.exit_code, 0);
  EXPECT_TRUE(holds(saved.err, "its description is damaged: its samples are converted")) << saved.err;
  const Json scan = Json::parse(saved.out)["outputs"][0]["scans"][0];
  EXPECT_EQ(scan["samples"], 4);
  EXPECT_FALSE(scan.contains("records"));
}

// A list in a range image is the list that was in the file: the same planes, bytes and all.
TEST_F(ConvertRecords, AListOfPointsIsTheSameInputForPlanes) {
  const fs::path room = data("scans/pcl-room/room_scan1.pcd");
  if (!fs::exists(room)) GTEST_SKIP() << room << " is not there";
  expect_done("convert '" + room.string() + "' room_scan1.exr");
  const Json info = Json::parse(hybrid("info room_scan1.exr --json").out)["scans"][0];
  EXPECT_EQ(info["points"], 112586);
  EXPECT_EQ(info["rows"], 0);
  expect_done("planes room_scan1.exr --out image");
  expect_done("planes '" + room.string() + "' --out file");
  const std::string scan = "/scans/room_scan1/";
  for (const std::string name : {"planes.json", "detail.ply", "labels.exr"})
    EXPECT_TRUE(same("image" + scan + name, "file" + scan + name)) << name;
}

}  // namespace
}  // namespace hybrid::e2e
