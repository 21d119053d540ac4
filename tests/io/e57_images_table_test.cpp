// Every kind of image that an E57 file can hold: as it is described, as a photograph, and byte
// for byte through conversions.
#include <gtest/gtest.h>

#include "io/e57/e57_photographs.hpp"
#include "io/e57_image_rows.hpp"
#include "io/exr/exr_e57.hpp"

namespace hybrid::testing {
namespace {

std::string text(const std::vector<char>& bytes) {
  return {bytes.begin(), bytes.end()};
}

void expect_rows(const std::filesystem::path& path) {
  const io::E57File file(path);
  const auto& images = file.contents().images;
  ASSERT_EQ(images.size(), std::size(kImageRows));
  const auto found = io::e57_photographs(file.contents());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const ImageRow& row = kImageRows[i];
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
      EXPECT_EQ(other.png, kImageRows[i - 1].png);
      EXPECT_EQ(other.width, 8);
      EXPECT_EQ(text(file.read_blob(other.picture, row.name)), picture_of(kImageRows[i - 1]));
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
  const auto file = write_image_rows(folder.path());
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
  const auto file = write_image_rows(folder.path()), copy = folder.path() / "copy.e57",
             back = folder.path() / "back.e57";
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
