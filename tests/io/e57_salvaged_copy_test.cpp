// Copies of damaged E57 files: what is left of them, as it was stored.
#include <gtest/gtest.h>

#include <algorithm>

#include "io/e57/e57_source.hpp"
#include "io/e57_grids.hpp"
#include "io/e57_scans.hpp"
#include "io/exr/exr_e57.hpp"

namespace hybrid::testing::e57_salvaged_copy_test {
namespace {
namespace fs = std::filesystem;

constexpr int kRows = 421, kCols = 330;

std::string zeroed(std::string bytes, std::size_t page, std::size_t count = 1) {
  return bytes.replace(1024 * page, 1024 * count, std::string(1024 * count, '\0'));
}

// The rows of a table that a reader in salvage does not call lost.
E57Columns good_rows(const io::E57File& file, std::size_t scan) {
  const io::E57Table& table = file.contents().scans.at(scan).points;
  std::vector<std::size_t> fields(table.fields.size());
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k] = k;
  E57Columns good{std::vector<std::vector<std::int64_t>>(fields.size()),
                  std::vector<std::vector<double>>(fields.size())};
  file.for_each_block(table, fields, 10'000, [&](const io::E57Records& block) {
    std::vector<char> lost(block.count, 0);
    for (const auto& range : block.lost)
      for (std::uint64_t i = range.first; i < range.end; ++i) lost[i - block.first] = 1;
    for (std::size_t i = 0; i < block.count; ++i)
      for (std::size_t k = 0; k < fields.size() && !lost[i]; ++k)
        table.fields[k].is_integer() ? good.integers[k].push_back(block.integers[k][i])
                                     : good.reals[k].push_back(block.reals[k][i]);
  });
  return good;
}

class E57SalvagedCopy : public ::testing::Test {
 protected:
  // Of a damaged file: its copy, and the same by way of a range image. How many records are left.
  std::uint64_t expect_copied(const std::string& bytes, std::size_t scans = 1) {
    const fs::path damaged = folder_.write("damaged.e57", bytes), copy = folder_.path() / "copy.e57",
                   back = folder_.path() / "back.e57";
    EXPECT_THROW(io::copy_e57(io::E57FileSource(damaged), copy), Error);
    const io::E57FileSource source(damaged, {}, {.salvage = true});
    dropped_ = source.dropped();
    notes_ = source.notes(scans - 1);
    io::copy_e57(source, copy);
    const io::E57File read(copy), original(damaged, {.salvage = true});
    EXPECT_EQ(read.contents().scans.size(), scans);
    std::uint64_t left = 0;
    std::vector<fs::path> images;
    const std::string sums = io::write_exr_parts(source, folder_.path() / "a.parts");
    for (std::size_t k = 0; k < scans; ++k) {
      const auto good = good_rows(original, k);
      EXPECT_TRUE(read_columns(read, k) == good);
      left += good.records().count;
      EXPECT_EQ(read.contents().scans[k].points.count, good.records().count);
      images.push_back(folder_.path() / fmt::format("a-{}.exr", k));
      io::write_exr_scan(source, k, images.back(), folder_.path() / "a.parts", sums);
    }
    io::copy_e57(io::ExrSource(images), back);
    EXPECT_EQ(bytes_of(back), bytes_of(copy));
    return left;
  }

  TemporaryFolder folder_;
  std::vector<std::string> dropped_, notes_;
};

TEST_F(E57SalvagedCopy, RecordsThatAreLeft) {
  const fs::path file = folder_.path() / "a.e57";
  constexpr std::uint64_t kAll = kRows * kCols;
  for (const bool by_columns : {true, false}) {
    e57_of(file, kRows, kCols, all_nodes(kRows, kCols, by_columns));
    const std::string bytes = bytes_of(file);
    const std::uint64_t one = expect_copied(zeroed(bytes, 60));
    EXPECT_LT(one, kAll);
    EXPECT_GT(one, kAll - 20'000);
    ASSERT_EQ(notes_.size(), 2u);
    EXPECT_EQ(notes_[0], "1 damaged pages of 1024 bytes, the first at byte 61440");
    EXPECT_TRUE(holds(notes_[1], fmt::format("{} of {} points (", kAll - one, kAll)));
    EXPECT_TRUE(holds(notes_[1], " %) are lost to damage: left out"));
    const std::uint64_t many = expect_copied(zeroed(zeroed(bytes, 60), 500, 300));
    EXPECT_LT(many, one - 10'000);
    EXPECT_GT(many, kAll / 2);
    EXPECT_TRUE(dropped_.empty());
  }
}

// A file that is whole is copied as without salvage; what follows its last point is none.
TEST_F(E57SalvagedCopy, WhatIsWholeStays) {
  const fs::path file = folder_.path() / "a.e57", copy = folder_.path() / "copy.e57";
  e57_of(file, kRows, kCols, all_nodes(kRows, kCols, true));
  const io::E57FileSource source(file, {}, {.salvage = true});
  EXPECT_TRUE(source.notes(0).empty() && source.dropped().empty());
  io::copy_e57(source, copy);
  EXPECT_EQ(bytes_of(copy), bytes_of(file));
  const std::string count = fmt::format("recordCount=\"{}\"", kRows * kCols);
  const std::string more = with_xml(bytes_of(file), count, "recordCount=\"200000\"");
  EXPECT_GE(expect_copied(more), std::uint64_t{kRows * kCols});
  EXPECT_TRUE(holds(notes_.at(0), "expected 200000 points"));
}

TEST_F(E57SalvagedCopy, GroupsOfPointsAndPictures) {
  const fs::path file = folder_.path() / "a.e57";
  const auto fields =
      std::vector<io::E57Field>{real_field("cartesianX"), real_field("cartesianY"), real_field("cartesianZ")};
  const auto columns = random_columns(fields, 3000);
  const auto lines = std::vector<io::E57Field>{integer_field("startPointIndex", 0, 3000),
                                               integer_field("pointCount", 0, 3000)};
  {
    io::E57Writer writer(file);
    io::E57Scan scan;
    scan.points.fields = fields;
    writer.begin_scan(scan);
    writer.write(columns.records());
    writer.end_scan();
    writer.add_image({.name = "first", .width = 4, .height = 3}, std::string(5000, 'p'));
    writer.add_image({.name = "second", .width = 4, .height = 3}, std::string(5000, 'q'));
    scan.points.fields = lines;
    writer.begin_scan(scan);
    writer.write(random_columns(lines, 2000).records());
    writer.end_scan();
    writer.close();
  }
  // The second table becomes the first scan's lines of points.
  std::string bytes = bytes_of(file);
  const std::string content = without_checksums(bytes);
  const std::size_t second = content.rfind("<vectorChild type=\"Structure\">", content.rfind("<points"));
  ASSERT_NE(second, content.npos);
  const std::size_t table = content.find("<points", second), end = content.find("</points>", table);
  const std::string points = content.substr(table, end + 9 - table);
  const std::size_t child_end = content.find("</vectorChild>", end) + 14;
  bytes = with_xml(bytes, content.substr(second, child_end - second), "");
  std::string groups = points;
  groups.replace(0, 7, "<groups").replace(groups.rfind("</points>"), 9, "</groups>");
  bytes = with_xml(bytes, "</points>",
                   "</points><pointGroupingSchemes type=\"Structure\"><groupingByLine type=\"Structure\">"
                   "<idElementName type=\"String\">columnIndex</idElementName>" +
                       groups + "</groupingByLine></pointGroupingSchemes>");
  const auto page_of = [&](const std::string& what) {
    return without_checksums(bytes).find(what) / 1020 + 1;
  };
  folder_.write("whole.e57", bytes);
  EXPECT_TRUE(io::E57FileSource(folder_.path() / "whole.e57").dropped().empty());
  // A picture.
  EXPECT_EQ(expect_copied(zeroed(bytes, page_of("qqqq") + 1)), 3000u);
  ASSERT_EQ(dropped_.size(), 1u);
  EXPECT_TRUE(holds(dropped_[0], "photograph second (damaged: ")) << dropped_[0];
  const io::E57File copy(folder_.path() / "copy.e57");
  ASSERT_EQ(copy.contents().images.size(), 1u);
  EXPECT_EQ(copy.contents().images[0].name, "first");
  EXPECT_TRUE(holds(copy.xml(), "<groupingByLine"));
  // Points, whose numbers the lines of points name.
  EXPECT_LT(expect_copied(zeroed(bytes, 3)), 3000u);
  ASSERT_EQ(dropped_.size(), 1u);
  EXPECT_TRUE(holds(dropped_[0], "groups of points of scan 0")) << dropped_[0];
  EXPECT_FALSE(holds(io::E57File(folder_.path() / "copy.e57").xml(), "pointGroupingSchemes"));
  // The lines themselves: the last packet before the description.
  EXPECT_EQ(expect_copied(zeroed(bytes, page_of("<?xml") - 2)), 3000u);
  EXPECT_EQ(dropped_, std::vector<std::string>{"table groups"});
}

// XML that says a number twice is read by the first, and changed there.
TEST_F(E57SalvagedCopy, AttributesThatAreThereTwice) {
  const fs::path file = folder_.path() / "a.e57";
  e57_of(file, kRows, kCols, all_nodes(kRows, kCols, true));
  const std::string count = fmt::format("recordCount=\"{}\"", kRows * kCols);
  const std::string twice = with_xml(bytes_of(file), "fileOffset=\"48\" " + count,
                                     "fileOffset=\"48\" " + count + " recordCount=\"0\" fileOffset=\"3\"");
  EXPECT_LT(expect_copied(zeroed(twice, 60)), std::uint64_t{kRows * kCols});
}

// Where it cannot be told what the records are.
TEST_F(E57SalvagedCopy, ADamagedDescription) {
  const fs::path file = folder_.path() / "a.e57";
  e57_of(file, 9, 8, all_nodes(9, 8, true));
  std::string bytes = bytes_of(file);
  bytes[bytes.find("<guid")] ^= 1;
  const auto damaged = folder_.write("damaged.e57", bytes);
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::E57FileSource(damaged, {}, {.salvage = true}); }),
                    "XML section"));
}

}  // namespace
}  // namespace hybrid::testing::e57_salvaged_copy_test
