// E57 files that are cut, or whose header does not lead to the description.
#include <gtest/gtest.h>

#include "io/allocation_watch.hpp"
#include "io/e57_scans.hpp"

namespace hybrid::testing::e57_lost_xml_test {
namespace {

constexpr std::size_t kCount = 2000;

class E57LostXml : public ::testing::Test {
 protected:
  E57LostXml() {
    io::E57Scan scan{.name = "nave"};
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
      scan.points.fields.push_back(scaled_field(name, -5000, 5000, 1e-3));
    const auto file = folder_.path() / "good.e57";
    io::E57Writer writer(file);
    for (int i = 0; i < 3; ++i) {
      writer.begin_scan(scan);
      writer.write(random_columns(scan.points.fields, kCount).records());
      writer.end_scan();
    }
    writer.close();
    good_ = bytes_of(file);
    xml_ = without_checksums(good_).find("<?xml");
  }
  static std::string notes_of(const io::E57File& file) {
    std::string text;
    for (const std::string& note : file.notes()) text += note + "\n";
    return text;
  }

  TemporaryFolder folder_;
  std::string good_;
  std::size_t xml_ = 0;  // logical
};

TEST_F(E57LostXml, CutBeforeItWhatCannotBeDoneIsTold) {
  const auto file = folder_.write("cut.e57", good_.substr(0, xml_ / 1020 * 1024));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::E57File{file}; }), "cut.e57: byte 16"));
  const AllocationWatch watch;
  const std::string message = error_of(ErrorKind::input, [&] { io::E57File(file, {.salvage = true}); });
  EXPECT_TRUE(holds(message, "cut.e57: byte 24: expected an XML section, found none"));
  EXPECT_TRUE(holds(message, "points are there at byte 48 ("));
  std::size_t tables = 0;
  for (std::size_t at = 0; (at = message.find("3 streams)", at)) != message.npos; ++at) ++tables;
  EXPECT_EQ(tables, 3u) << message;
  EXPECT_TRUE(holds(message, "copy the file again"));
  EXPECT_LT(watch.largest_bytes(), 2u << 20);
  const auto empty = folder_.write("none.e57", good_.substr(0, 1024));
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { io::E57File(empty, {.salvage = true}); }), "points are there"));
}

// The first scans of a description that breaks off are described.
TEST_F(E57LostXml, CutWithinItTheScansBeforeTheCutAreRead) {
  const std::string content = without_checksums(good_);
  const std::size_t second = content.find("vectorChild", content.find("vectorChild", xml_) + 400);
  ASSERT_NE(second, content.npos);
  for (const std::size_t back : {std::size_t{0}, std::size_t{300}}) {
    const std::size_t cut = content.rfind("</vectorChild>") + 14 - back;
    const std::string pages = with_checksums(content.substr(0, cut));
    const auto file = folder_.write("cut.e57", pages.substr(0, pages.size() - 1020 + cut % 1020));
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::E57File{file}; }), "byte 16"));
    const io::E57File salvaged(file, {.salvage = true});
    ASSERT_GE(salvaged.contents().scans.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(io::read_e57(salvaged, i).points.size(), kCount);
    EXPECT_TRUE(holds(notes_of(salvaged), "well-formed XML"));
  }
}

TEST_F(E57LostXml, AHeaderThatLeadsElsewhereIsNotBelieved) {
  for (const std::uint64_t offset : {std::uint64_t{1} << 60, std::uint64_t{2048}, std::uint64_t{1022}}) {
    SCOPED_TRACE(offset);
    const auto file = folder_.write("lie.e57", overwritten(good_, 24, little_endian(offset)));
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::E57File{file}; }), "lie.e57: "));
    const auto scans = io::read_e57(file, {.salvage = true});
    ASSERT_EQ(scans.size(), 3u);
    for (const Scan& scan : scans) EXPECT_EQ(scan.points.size(), kCount);
    EXPECT_TRUE(holds(notes_of(io::E57File(file, {.salvage = true})), "the XML section is taken from byte"));
  }
}

}  // namespace
}  // namespace hybrid::testing::e57_lost_xml_test
