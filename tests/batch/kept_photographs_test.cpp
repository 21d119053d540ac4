#include "batch/photographs/kept_photographs.hpp"

#include <gtest/gtest.h>

#include "io/files.hpp"
#include "io/picture.hpp"

namespace hybrid::batch {
namespace {
using testing::TemporaryFolder;

Image8 picture(int seed) {
  Image8 image(7, 5, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint8_t>(37 * i + static_cast<std::size_t>(seed));
  return image;
}

}  // namespace

// In memory, on disk and decoded again: the same pixels, whatever the budget.
TEST(KeptPhotographs, gives_the_pixels_that_were_added_whatever_the_budget) {
  const TemporaryFolder scratch;
  const std::size_t each = picture(0).pixels.size();
  for (int i = 0; i < 3; ++i) io::write_png(scratch.path() / (std::to_string(i) + ".png"), picture(i));
  for (const std::size_t budget : {std::size_t{0}, each, 3 * each})
    for (const std::uint64_t on_disk : {std::uint64_t{0}, std::uint64_t{3 * each}}) {
      KeptPhotographs kept(budget, on_disk);
      std::vector<KeptPhotographs::File> files;
      for (int i = 0; i < 3; ++i) files.push_back({scratch.path() / (std::to_string(i) + ".png"), 7, 5});
      kept.add(files);
      ASSERT_EQ(kept.count(), 3u);
      for (const std::size_t i : {2u, 0u, 1u, 0u}) {
        EXPECT_EQ(kept.get(i)->pixels, picture(static_cast<int>(i)).pixels) << budget << ' ' << on_disk;
        EXPECT_EQ(kept.size(i).width, 7);
        EXPECT_TRUE(kept.size(i).pixels.empty());
      }
    }
}

// Of several that are wrong the first is named, whichever thread comes to its end first.
TEST(KeptPhotographs, names_the_first_that_is_wrong) {
  const TemporaryFolder scratch;
  io::write_png(scratch.path() / "a.png", picture(0));
  KeptPhotographs kept;
  try {
    kept.add({{scratch.path() / "a.png", 7, 5},
              {scratch.path() / "b.png", 7, 5},
              {scratch.path() / "c.png", 7, 5}});
    FAIL() << "two of the files do not exist";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("b.png"), std::string::npos) << error.what();
  }
}

// Decoded once where there is room on disk: the file may be gone by the time it is asked for.
TEST(KeptPhotographs, what_memory_does_not_hold_is_not_decoded_again) {
  const TemporaryFolder scratch;
  const auto file = scratch.path() / "a.png";
  io::write_png(file, picture(1));
  const std::size_t each = picture(1).pixels.size();
  if (!ScratchFile::make(each)) GTEST_SKIP() << "no room on disk in " << scratch_folder();
  KeptPhotographs kept(0, each);
  kept.add({{file, 7, 5}});
  std::filesystem::remove(file);
  EXPECT_EQ(kept.get(0)->pixels, picture(1).pixels);
}

}  // namespace hybrid::batch
