#include "batch/photographs/photograph_files.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "io/files.hpp"

namespace hybrid::testing::photograph_files_test {
namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

struct Set {
  TemporaryFolder folder;
  io::SceneFile::Photographs section;
  std::vector<Photograph> cameras;

  Set(const Names& names, const Names& files) {
    section.images = folder.path();
    section.cameras.path = "transforms.json";
    for (const auto& name : names) cameras.emplace_back().name = name;
    for (const auto& file : files) folder.write(file, "picture");
  }
  Names found() const {
    Names names;
    for (const auto& file : batch::find_photographs(section, cameras).all)
      names.push_back(fs::relative(file, folder.path()).generic_string());
    return names;
  }
};
TEST(PhotographFiles, lie_where_their_names_lead) {
  const Set set({"a.jpg", "day1/a.jpg"}, {"a.jpg", "day1/a.jpg"});
  EXPECT_EQ(set.found(), (Names{"a.jpg", "day1/a.jpg"}));
  const auto files = batch::photograph_files(set.section, set.cameras);
  EXPECT_TRUE(files.missing.empty());
  EXPECT_EQ(files.note, "");
}

TEST(PhotographFiles, or_where_the_ends_of_their_names_do) {
  EXPECT_EQ(Set({"images/a.jpg", "images/b.jpg"}, {"a.jpg", "b.jpg"}).found(), (Names{"a.jpg", "b.jpg"}));
  EXPECT_EQ(Set({"images/1/a.jpg", "images/2/a.jpg"}, {"1/a.jpg", "2/a.jpg", "a.jpg"}).found(),
            (Names{"1/a.jpg", "2/a.jpg"}));
  EXPECT_EQ(Set({"C:\\images\\a.jpg"}, {"a.jpg"}).found(), Names{"a.jpg"});
  EXPECT_EQ(Set({"train/a.png", "b.png"}, {"train/a.jpg", "b.JPG"}).found(), (Names{"train/a.jpg", "b.JPG"}));
  const Set set({"images/a.jpg", "b.jpg"}, {"a.jpg", "b.jpg"});
  const auto files = batch::photograph_files(set.section, set.cameras);
  EXPECT_TRUE(files.missing.empty());
  EXPECT_NE(files.note.find("1 of 2 photographs"), std::string::npos) << files.note;
  EXPECT_NE(files.note.find("a.jpg for "), std::string::npos) << files.note;
}

// All of them, each its own: else the names lead elsewhere.
TEST(PhotographFiles, are_missing_where_these_do_not_lead_to_all) {
  const std::pair<Names, Names> cases[] = {{{"images/a.jpg", "images/b.jpg"}, {"a.jpg"}},
                                           {{"day1/a.jpg", "day2/a.jpg"}, {"a.jpg"}},
                                           {{"a.jpg"}, {"A.jpg"}}};
  for (const auto& [names, files] : cases) {
    const Set set(names, files);
    const auto found = batch::find_photographs(set.section, set.cameras);
    EXPECT_EQ(found.missing.size(), set.cameras.size());
    EXPECT_EQ(found.all, found.missing);
    EXPECT_EQ(found.note, "");
    EXPECT_THROW(batch::photograph_files(set.section, set.cameras), Error);
    EXPECT_EQ(batch::photograph_files(set.section, set.cameras, true).missing.size(), found.missing.size());
  }
}

}  // namespace
}  // namespace hybrid::testing::photograph_files_test
