// Files made to harm: names that lead elsewhere, descriptions that blow up.
#include <gtest/gtest.h>

#include <chrono>

#include "io/allocation_watch.hpp"
#include "io/e57/e57_xml.hpp"
#include "io/e57_scans.hpp"
#include "io/models/obj.hpp"
#include "io/read_scan.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::testing {
namespace {

// Strict and salvaging (which may leave it out instead): refused in time and memory that its size justifies.
void expect_bounded(const std::string& xml, const std::string& message, bool left_out = false) {
  for (const bool salvage : {false, true}) {
    const AllocationWatch watch;
    const auto start = std::chrono::steady_clock::now();
    const auto parse = [&] { return io::parse_e57_xml("a.e57", xml, salvage); };
    const std::string told = salvage && left_out ? parse().notes.at(0) : error_of(ErrorKind::input, parse);
    EXPECT_TRUE(holds(told, message));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    EXPECT_LE(watch.largest_bytes(), (1u << 20) + 4 * xml.size());
  }
}

std::string repeated(const std::string& part, std::size_t count) {
  std::string text;
  text.reserve(part.size() * count);
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

TEST(HostileXml, Entities) {
  std::string laughs = "<!DOCTYPE lolz [<!ENTITY a \"ha\">";
  for (char c = 'b'; c <= 'z'; ++c)
    laughs +=
        fmt::format("<!ENTITY {} \"{}\">", c, repeated(fmt::format("&{};", static_cast<char>(c - 1)), 10));
  expect_bounded("<?xml version=\"1.0\"?>" + laughs + "]><e57Root><guid>&z;</guid></e57Root>",
                 "document type");
  expect_bounded(
      "<!DOCTYPE r [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><e57Root><guid>&x;</guid></e57Root>",
      "document type");
  // Without its declaration an entity is text.
  const auto contents =
      io::parse_e57_xml("a.e57", "<e57Root><guid>&x; &amp; &#65;</guid><images2D/></e57Root>", false);
  EXPECT_EQ(contents.guid, "&x; & A");
}

TEST(HostileXml, DeepAndHuge) {
  expect_bounded("<e57Root>" + repeated("<a>", 200'000) + repeated("</a>", 200'000) + "</e57Root>", "nested");
  expect_bounded("<e57Root>" + repeated("<a/>", 4'000'001) + "</e57Root>", "at most 4000000 elements");
}

// Each broken description could take a walk through all of the text.
TEST(HostileXml, ManyBrokenDescriptions) {
  expect_bounded("<e57Root><data3D>" + repeated("<s/>", 500'000) + "</data3D></e57Root>",
                 "expected <points>");
}

TEST(HostileXml, ThousandsOfFields) {
  std::string fields;
  for (int i = 0; i < 3000; ++i) fields += fmt::format("<f{} type=\"Float\"/>", i);
  expect_bounded(
      "<e57Root><data3D><s><points type=\"CompressedVector\" fileOffset=\"48\" "
      "recordCount=\"1\"><prototype>" +
          fields + "</prototype></points></s></data3D></e57Root>",
      "at most 1024 fields", true);
}

// What a file calls itself inside is told, and names no file.
TEST(HostileNames, InsideE57) {
  const TemporaryFolder folder;
  io::E57Scan scan{.name = "../../../etc/passwd"};
  scan.points.fields = {real_field("cartesianX"), real_field("cartesianY"), real_field("cartesianZ")};
  const auto file = folder.path() / "west.e57";
  io::E57Writer writer(file);
  for (const char* name : {"../../../etc/passwd", "/etc/passwd"}) {
    scan.name = name;
    writer.begin_scan(scan);
    writer.write(random_columns(scan.points.fields, 3).records());
    writer.end_scan();
  }
  writer.add_image({.guid = "../image", .name = "../../image", .width = 1, .height = 1}, std::string("JPEG"));
  writer.close();
  const auto entries = io::list_scans(file);
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].name, "west-0");
  EXPECT_EQ(io::read_scan(file, entries[1]).name, "west-1");
}

TEST(HostileNames, InScenes) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    const auto file = folder.write("scene.toml", text);
    return error_of(ErrorKind::input, [&] { io::read_scene_file(file); });
  };
  for (const char* id : {"..", ".", "../up", "/etc", "a/../../b", "a\\\\b"})
    EXPECT_TRUE(holds(refused(fmt::format("[[scan]]\nid = \"{}\"\nfile = \"a.ply\"\n", id)), "folder")) << id;
  for (const char* text : {"id = \"a\\u0000b\"\nfile = \"a.ply\"", "id = \"a\"\nfile = \"a.ply\\u0000.txt\"",
                           "id = \"a\\nb\"\nfile = \"a.ply\""})
    EXPECT_TRUE(holds(refused(fmt::format("[[scan]]\n{}\n", text)), "control characters")) << text;
}

// Materials are not read: no file that a model names is opened, and the names of faces stay names.
TEST(HostileNames, InModels) {
  const TemporaryFolder folder;
  const auto model =
      io::read_obj(folder.write("box.obj",
                                "mtllib ../../../etc/passwd\nmtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                "usemtl ../../gold\nf 1 2 3\ng ../../../tmp/door\nf 3 2 1\n"));
  ASSERT_EQ(model.faces.size(), 2u);
  EXPECT_EQ(model.faces[0].name, "../../gold");
  EXPECT_EQ(model.faces[1].name, "../../../tmp/door");
}

// Two bytes a scan: what is kept of each must not add up.
TEST(HostileText, MoreScansThanAnyoneMade) {
  const TemporaryFolder folder;
  const auto file = folder.write("zeros.pts", repeated("0\n", 300'000));
  for (const bool salvage : {false, true}) {
    std::vector<io::ScanEntry> entries;
    try {
      entries = io::list_scans(file, {.salvage = salvage});
    } catch (const Error& error) {
      EXPECT_TRUE(holds(error.what(), "at most 100000 counts"));
    }
    EXPECT_LE(entries.size(), 100'001u);
  }
}

}  // namespace
}  // namespace hybrid::testing
