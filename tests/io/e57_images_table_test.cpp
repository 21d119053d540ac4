// Every kind of image that an E57 file can hold, one row each: as it is described, as a photograph, and byte
// for byte through conversions.
#include <gtest/gtest.h>

#include "io/e57/e57_photographs.hpp"
#include "io/e57/e57_source.hpp"
#include "io/e57_scans.hpp"
#include "io/exr_e57.hpp"
#include "io/files.hpp"

namespace hybrid::testing {
namespace {

using io::E57Projection;

constexpr const char* kScanGuid = "{a-scan}";

struct Row {
  const char* name;
  E57Projection projection;
  bool png = false, mask = false, pose = true, scan = false;
  bool reference = false;  // a visual reference beside it
  bool photograph = true;  // has a camera
};

const Row kRows[] = {
    {.name = "pinhole jpeg", .projection = E57Projection::pinhole},
    {.name = "pinhole png mask", .projection = E57Projection::pinhole, .png = true, .mask = true},
    {.name = "pinhole scan", .projection = E57Projection::pinhole, .scan = true},
    {.name = "pinhole without a pose", .projection = E57Projection::pinhole, .pose = false},
    {.name = "spherical jpeg mask", .projection = E57Projection::spherical, .mask = true, .scan = true},
    {.name = "spherical png", .projection = E57Projection::spherical, .png = true},
    {.name = "spherical and reference", .projection = E57Projection::spherical, .reference = true},
    {.name = "cylindrical jpeg", .projection = E57Projection::cylindrical},
    {.name = "cylindrical png mask scan",
     .projection = E57Projection::cylindrical,
     .png = true,
     .mask = true,
     .scan = true},
    {.name = "cylindrical and reference",
     .projection = E57Projection::cylindrical,
     .mask = true,
     .reference = true},
    {.name = "reference jpeg", .projection = E57Projection::visual_reference, .photograph = false},
    {.name = "reference png mask",
     .projection = E57Projection::visual_reference,
     .png = true,
     .mask = true,
     .photograph = false},
    {.name = "reference scan",
     .projection = E57Projection::visual_reference,
     .pose = false,
     .scan = true,
     .photograph = false},
};

// Bytes that no two rows share; nothing decodes them here.
std::string picture_of(const Row& row) {
  return std::string("picture of ") + row.name;
}
std::string mask_of(const Row& row) {
  return std::string("mask of ") + row.name;
}

io::E57Image image_of(const Row& row) {
  io::E57Image image{
      .name = row.name, .projection = row.projection, .png = row.png, .width = 40, .height = 20};
  image.guid = std::string("{") + row.name + "}";
  if (row.scan) image.scan_guid = kScanGuid;
  if (row.pose) image.world_from_image = Pose{1, Eigen::Quaterniond(0.8, 0, 0.6, 0), {1, 2, 3.5}};
  image.focal_length_m = 0.02;
  const bool pinhole = row.projection == E57Projection::pinhole;
  image.pixel_width = pinhole ? 1e-4 : 0.01;
  image.pixel_height = pinhole ? 2e-4 : 0.02;
  image.principal_x = 19.5;
  image.principal_y = 11;
  image.radius_m = 0.25;
  return image;
}

// A scan and all rows; a row's reference is put into the description, which E57Writer has no words for: it
// shows the picture of the row before.
std::filesystem::path write_rows(const TemporaryFolder& folder) {
  const auto file = folder.path() / "plain.e57";
  io::E57Writer writer(file, {.guid = "{file}"});
  io::E57Scan scan{.guid = kScanGuid, .name = "scan"};
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back(real_field(axis));
  writer.begin_scan(scan);
  writer.write(random_columns(scan.points.fields, 10).records());
  writer.end_scan();
  for (const Row& row : kRows)
    writer.add_image(image_of(row), picture_of(row), row.mask ? mask_of(row) : std::string());
  writer.close();
  std::string bytes = bytes_of(file);
  const auto images = io::E57File(file).contents().images;
  for (std::size_t i = 0; i < std::size(kRows); ++i) {
    if (!kRows[i].reference) continue;
    const std::string end = kRows[i].projection == E57Projection::spherical ? "</sphericalRepresentation>"
                                                                            : "</cylindricalRepresentation>";
    const std::string xml = io::E57File(folder.write("now.e57", bytes)).xml();
    const auto from = xml.find(kRows[i].name);
    const std::string element = xml.substr(from, xml.find(end, from) + end.size() - from);
    const io::E57Blob& blob = images[i - 1].picture;
    bytes = with_xml(
        bytes, element,
        element + fmt::format("<visualReferenceRepresentation type=\"Structure\"><{0}Image type=\"Blob\" "
                              "fileOffset=\"{1}\" length=\"{2}\"/><imageWidth type=\"Integer\">8</imageWidth>"
                              "<imageHeight type=\"Integer\">4</imageHeight></visualReferenceRepresentation>",
                              kRows[i - 1].png ? "png" : "jpeg", blob.offset, blob.length));
  }
  return folder.write("in.e57", bytes);
}

std::string text(const std::vector<char>& bytes) {
  return {bytes.begin(), bytes.end()};
}

void expect_rows(const std::filesystem::path& path) {
  const io::E57File file(path);
  const auto& images = file.contents().images;
  ASSERT_EQ(images.size(), std::size(kRows));
  const auto found = io::e57_photographs(file.contents());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Row& row = kRows[i];
    const io::E57Image &image = images[i], expected = image_of(row);
    SCOPED_TRACE(row.name);
    EXPECT_EQ(image.name, row.name);
    EXPECT_EQ(image.guid, expected.guid);
    EXPECT_EQ(image.projection, row.projection);
    EXPECT_EQ(image.png, row.png);
    EXPECT_EQ(image.width, 40);
    EXPECT_EQ(image.height, 20);
    EXPECT_EQ(image.scan_guid, row.scan ? kScanGuid : "");
    EXPECT_EQ(text(file.read_blob(image.picture, row.name)), picture_of(row));
    ASSERT_EQ(image.mask.has_value(), row.mask);
    if (row.mask) {
      EXPECT_EQ(text(file.read_blob(*image.mask, row.name)), mask_of(row));
    }
    ASSERT_EQ(image.world_from_image.has_value(), row.pose);
    if (row.pose) {
      EXPECT_EQ(image.world_from_image->translation, Vec3(1, 2, 3.5));
      EXPECT_NEAR(image.world_from_image->rotation.y(), 0.6, 1e-15);
    }
    ASSERT_EQ(image.others.size(), row.reference ? 1u : 0u);
    if (row.reference) {
      const io::E57Representation& other = image.others[0];
      EXPECT_EQ(other.projection, E57Projection::visual_reference);
      EXPECT_EQ(other.png, kRows[i - 1].png);
      EXPECT_EQ(other.width, 8);
      EXPECT_EQ(text(file.read_blob(other.picture, row.name)), picture_of(kRows[i - 1]));
    }
    const auto one = std::ranges::find(found.photographs, i, &io::E57Photograph::image);
    ASSERT_EQ(one != found.photographs.end(), row.photograph);
    if (!row.photograph) continue;
    EXPECT_EQ(one->photograph.name, row.name);
    EXPECT_EQ(one->scan, row.scan ? std::optional<std::size_t>(0) : std::nullopt);
    EXPECT_LT((one->photograph.centre() - (row.pose ? Vec3(1, 2, 3.5) : Vec3(0, 0, 0))).norm(), 1e-12);
  }
}

}  // namespace

TEST(E57ImagesTable, EveryKindIsRead) {
  const TemporaryFolder folder;
  const auto file = write_rows(folder);
  expect_rows(file);
  const auto found = io::e57_photographs(io::E57File(file).contents());
  const auto noted = [&](const std::string& part) {
    return std::ranges::count_if(found.notes,
                                 [&](const std::string& note) { return note.find(part) != note.npos; });
  };
  EXPECT_EQ(noted("no pose"), 1);
  EXPECT_EQ(noted("a visual reference has no camera"), 3);
}

TEST(E57ImagesTable, EveryKindSurvivesConversion) {
  const TemporaryFolder folder;
  const auto file = write_rows(folder), copy = folder.path() / "copy.e57", back = folder.path() / "back.e57";
  io::copy_e57(io::E57FileSource(file), copy);
  expect_rows(copy);
  const io::E57FileSource source(file);
  const auto image = folder.path() / "a.exr", parts = folder.path() / "a.parts";
  io::write_exr_scan(source, 0, image, parts, io::write_exr_parts(source, parts));
  io::copy_e57(io::ExrSource({image}), back);
  expect_rows(back);
  EXPECT_EQ(bytes_of(copy), bytes_of(back));
}

}  // namespace hybrid::testing
