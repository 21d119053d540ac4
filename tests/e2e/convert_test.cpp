// `hybrid convert` and `hybrid info` on files of several scans, as users run them.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "program.hpp"
#include "small_ptx.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

class Convert : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  std::string bytes(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // "hybrid " and arguments, of which those that end in a scan's extension are files of the folder.
  Outcome hybrid(const std::string& arguments) const {
    return run("cd '" + folder_.path().string() + "' && hybrid " + arguments);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  static bool holds(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

  void expect_refused(const std::string& arguments, int code, const std::vector<std::string>& parts) {
    SCOPED_TRACE(arguments);
    const std::size_t before = files();
    const Outcome outcome = hybrid(arguments);
    EXPECT_EQ(outcome.exit_code, code);
    EXPECT_EQ(outcome.out, "");
    for (const std::string& part : parts)
      EXPECT_TRUE(holds(outcome.err, part)) << part << " in: " << outcome.err;
    EXPECT_EQ(files(), before);
  }

  Scratch folder_;
  const std::string scan_ = kHeader + "5 6 7 1\n" + kPoints, other_ = kHeader + "0 0 0 1\n" + kPoints;
};

TEST_F(Convert, PtxThroughPcdIsThePtxAgain) {
  write("a.ptx", scan_);
  EXPECT_EQ(hybrid("convert a.ptx b.pcd").exit_code, 0);
  const Outcome back = hybrid("convert b.pcd c.ptx --json");
  EXPECT_EQ(back.exit_code, 0);
  const std::string expected =
      "2\n2\n5 6 7\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n" + kPoints;
  EXPECT_EQ(bytes("c.ptx"), expected);
  const Json json = Json::parse(back.out);
  EXPECT_EQ(json["outputs"][0]["file"], "c.ptx");
  EXPECT_EQ(json["outputs"][0]["bytes"], expected.size());
  EXPECT_EQ(json["outputs"][0]["scans"][0]["samples"], 4);
  EXPECT_TRUE(json["outputs"][0]["scans"][0]["dropped"].empty());
}

TEST_F(Convert, DroppedFieldsAreNamed) {
  write("a.ptx", scan_);
  const Outcome outcome = hybrid("convert a.ptx b.las");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* part :
       {"LAS cannot hold it: grid (2 x 2), pose, no-returns (1)", "intensity scaled from 0..1 to 0..65535"})
    EXPECT_TRUE(holds(outcome.err, part)) << outcome.err;
  EXPECT_TRUE(holds(outcome.out, "b.las: 1 scan, 4 samples"));
}

TEST_F(Convert, SeveralScansGoIntoNumberedFilesOrOne) {
  write("a.ptx", scan_ + other_);
  EXPECT_EQ(hybrid("convert a.ptx b.ply").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "b-0.ply"));
  EXPECT_TRUE(fs::exists(folder_ / "b-1.ply"));
  EXPECT_FALSE(fs::exists(folder_ / "b.ply"));
  EXPECT_EQ(hybrid("convert a.ptx c.pts").exit_code, 0);
  EXPECT_EQ(bytes("c.pts").substr(0, 2), "3\n");
  EXPECT_EQ(Json::parse(hybrid("info c.pts --json").out)["scans"].size(), 2u);
  EXPECT_EQ(hybrid("convert a.ptx d.ply --index 1").exit_code, 0);
  EXPECT_EQ(bytes("d.ply"), bytes("b-1.ply"));
}

// Of several E57 files the first one's scans alone were written, without a word.
TEST_F(Convert, ScansOfSeveralFilesGoIntoOne) {
  write("a.ptx", scan_ + other_);
  write("b.ptx", other_);
  write("together.ptx", scan_ + other_ + other_);
  for (const char* file : {"a", "b"}) {
    const std::string name = file;
    EXPECT_EQ(hybrid("convert " + name + ".ptx " + name + ".e57").exit_code, 0);
  }
  const Outcome outcome = hybrid("convert a.e57 b.e57 c.e57");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(holds(outcome.out, "c.e57: 3 scans, 12 samples")) << outcome.out;
  EXPECT_EQ(hybrid("convert c.e57 c.ptx").exit_code, 0);
  EXPECT_EQ(hybrid("convert together.ptx direct.ptx").exit_code, 0);
  EXPECT_EQ(bytes("c.ptx"), bytes("direct.ptx"));
  // Formats may be mixed, and a file may be there twice.
  EXPECT_EQ(hybrid("convert a.ptx b.e57 d.ptx").exit_code, 0);
  EXPECT_EQ(bytes("d.ptx"), bytes("direct.ptx"));
  EXPECT_EQ(hybrid("convert a.ptx b.e57 b.ptx e.ptx --json").exit_code, 0);
  EXPECT_EQ(Json::parse(hybrid("info e.ptx --json").out)["scans"].size(), 4u);
  const Outcome told = hybrid("convert a.ptx b.e57 f.e57 --dry-run");
  EXPECT_TRUE(holds(told.out, "would write f.e57: a-0 (4 samples) a-1 (4 samples) b (4 samples)"))
      << told.out;
  expect_refused("convert a.e57 b.e57 f.ply", 2,
                 {"f.ply: expected one input", "PLY holds one scan, found 2"});
  expect_refused("convert a.e57 b.e57 f.e57 --index 0", 2, {"--index: expected one input"});
  expect_refused("convert a.e57 missing.e57 f.e57", 4, {"missing.e57: no such file"});
  expect_refused("convert a.e57 b.e57 b.e57", 2, {"b.e57: is the input itself"});
  EXPECT_FALSE(fs::exists(folder_ / "f.e57"));
  write("bad.ptx", kHeader + "0 0 0 1\n1 x 3\n" + kPoints.substr(kPoints.find('\n') + 1));
  const Outcome some = hybrid("convert a.ptx bad.ptx b.ptx g.e57");
  EXPECT_EQ(some.exit_code, 3);
  EXPECT_TRUE(holds(some.out, "failed: scan bad: ")) << some.out;
  EXPECT_EQ(Json::parse(hybrid("info g.e57 --json").out)["scans"].size(), 3u);
}

TEST_F(Convert, ADamagedScanDoesNotStopTheOthers) {
  write("a.ptx", kHeader + "0 0 0 1\n1 x 3\n" + kPoints.substr(kPoints.find('\n') + 1) + other_);
  const Outcome outcome = hybrid("convert a.ptx b.ptx");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(holds(outcome.err, "line 11: expected a number, found \"x\""));
  EXPECT_EQ(Json::parse(hybrid("info b.ptx --json").out)["scans"].size(), 1u);
  const Outcome info = hybrid("info a.ptx --json");
  EXPECT_EQ(info.exit_code, 3);
  const Json scans = Json::parse(info.out)["scans"];
  EXPECT_TRUE(holds(scans[0]["damage"].get<std::string>(), "line 11"));
  EXPECT_EQ(scans[1]["returns"], 3);
  write("c.ptx", kHeader + "0 0 0 1\n1 x 3\n" + kPoints.substr(kPoints.find('\n') + 1));
  expect_refused("convert c.ptx d.ply", 4, {"c.ptx", "line 11"});
}

TEST_F(Convert, WhatIsWrongIsNamedAndNothingIsWritten) {
  write("a.ptx", scan_ + other_);
  write("there.ply", "mine");
  write("there-1.pcd", "mine");
  fs::create_directory(folder_ / "folder.ply");
  expect_refused("convert a.ptx missing/b.ptx", 2, {"missing/b.ptx", "make it first"});
  expect_refused("convert a.ptx a.ptx", 2, {"a.ptx: is the input itself"});
  expect_refused("convert a.ptx ./a.ptx --force", 2, {"is the input itself"});
  expect_refused("convert a.ptx b.abc", 2, {"b.abc", ".ptx, .pts, .xyz, .ply, .pcd, .las", "found .abc"});
  expect_refused("convert a.ptx b", 2, {"found no extension"});
  expect_refused("convert a.ptx there.ply --index 0", 2, {"there.ply: is there already", "--force"});
  expect_refused("convert a.ptx there.pcd", 2, {"there-1.pcd: is there already"});
  expect_refused("convert a.ptx folder.ply --index 0", 2, {"found a folder"});
  expect_refused("convert a.ptx b.ply --index 2", 4, {"index 2", "holds 2 scans"});
  expect_refused("convert a.laz b.ptx", 4, {"a.laz: no such file"});
  expect_refused("convert nothing.ptx b.ptx", 4, {"nothing.ptx: no such file"});
  EXPECT_EQ(bytes("there.ply"), "mine");
  EXPECT_EQ(hybrid("convert a.ptx there.ply --index 0 --force").exit_code, 0);
  EXPECT_EQ(bytes("there.ply").substr(0, 4), "ply\n");
}

TEST_F(Convert, AReadOnlyFolderIsNamed) {
  write("a.ptx", scan_);
  fs::create_directory(folder_ / "locked");
  fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  if (std::ofstream(folder_ / "locked/probe")) {
    fs::remove(folder_ / "locked/probe");
    GTEST_SKIP() << "this user may write everywhere";
  }
  expect_refused("convert a.ptx locked/b.ptx", 1, {"locked: expected a writable output folder"});
}

TEST_F(Convert, DryRunWritesNothing) {
  write("a.ptx", scan_ + other_);
  const Outcome outcome = hybrid("convert a.ptx b.ply --dry-run");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(holds(outcome.out, "would write b-0.ply: a-0 (4 samples)")) << outcome.out;
  EXPECT_EQ(files(), 1u);
}

}  // namespace
TEST(Info, OfSeveralFilesOneThatIsBadDoesNotStopTheOthers) {
  const Scratch scratch;
  io::write_text(scratch / "a.xyz", "1 2 3\n4 5 6\n");
  io::write_text(scratch / "b.xyz", "hello\n");
  io::write_text(scratch / "c.pts", "2\n1 2 3\n4 5 6\n");
  const auto info = [&](const std::string& words) {
    std::string command = "hybrid info --json";
    for (const char name : words)
      command += " " + (scratch / (std::string(1, name) + (name == 'c' ? ".pts" : ".xyz"))).string();
    return run(command);
  };
  const Outcome all = info("abc");
  EXPECT_EQ(all.exit_code, 3);
  EXPECT_NE(all.err.find("b.xyz: line 1: expected numbers"), std::string::npos) << all.err;
  const auto json = nlohmann::json::parse(all.out);
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0]["scans"][0]["points"], 2);
  EXPECT_NE(json[1]["error"].get<std::string>().find("line 1"), std::string::npos);
  EXPECT_EQ(json[2]["scans"][0]["points"], 2);
  EXPECT_EQ(info("ac").exit_code, 0);
  EXPECT_EQ(info("bb").exit_code, 4);
  EXPECT_EQ(info("b").exit_code, 4);
  EXPECT_EQ(nlohmann::json::parse(info("a").out)["scans"][0]["points"], 2);
}

}  // namespace hybrid::e2e
