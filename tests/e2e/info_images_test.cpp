// `hybrid info` lists every image of an E57 file, and the same after `hybrid convert`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/e57_image_rows.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
using Json = nlohmann::json;

Json images_of(const std::filesystem::path& file) {
  const Outcome outcome = run("hybrid info '" + file.string() + "' --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return Json::parse(outcome.out)["images"];
}

}  // namespace

TEST(InfoImages, EveryKindIsListedAndSurvivesConversion) {
  const Scratch folder;
  const auto file = testing::write_image_rows(folder.path()), copy = folder.path() / "copy.e57";
  const Json images = images_of(file);
  ASSERT_EQ(images.size(), std::size(testing::kImageRows));
  for (std::size_t i = 0; i < images.size(); ++i) {
    const testing::ImageRow& row = testing::kImageRows[i];
    const Json& image = images[i];
    SCOPED_TRACE(row.name);
    EXPECT_EQ(image["name"], row.name);
    EXPECT_EQ(image["type"], io::name_of(row.projection));
    EXPECT_EQ(image["picture"], row.png ? "PNG" : "JPEG");
    EXPECT_EQ(image["bytes"], testing::picture_of(row).size());
    EXPECT_EQ(image["size"], Json({40, 20}));
    EXPECT_EQ(image["mask"], row.mask);
    EXPECT_EQ(image["world_from_image"].is_array(), row.pose);
    EXPECT_EQ(image["scan"], row.scan ? Json(0) : Json());
    EXPECT_EQ(image["photograph"], row.photograph ? Json(row.name) : Json());
    EXPECT_EQ(image.contains("also"), row.reference);
    if (row.reference) {
      EXPECT_EQ(image["also"][0]["type"], io::name_of(io::E57Projection::visual_reference));
      EXPECT_EQ(image["also"][0]["size"], Json({8, 4}));
    }
  }
  const Outcome converted = run("hybrid convert '" + file.string() + "' '" + copy.string() + "'");
  EXPECT_EQ(converted.exit_code, 0) << converted.err;
  EXPECT_EQ(images_of(copy), images);
}

}  // namespace hybrid::e2e
