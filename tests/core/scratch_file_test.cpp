#include "core/scratch_file.hpp"

#include <array>
#include <cstdlib>

#include "io/files.hpp"

namespace hybrid::testing {
namespace {

// Other tests' folder may lie in memory, where there are no scratch files.
std::filesystem::path disk() {
  return "/var/tmp";
}

}  // namespace

TEST(ScratchFile, GivesBackWhatWasWritten) {
  const auto file = ScratchFile::make(1 << 20, disk());
  if (!file) GTEST_SKIP() << disk() << " is no disk with a little room";
  const std::string some(70'000, 's'), other = "other";
  EXPECT_TRUE(file->write(100'000, some));
  EXPECT_TRUE(file->write(0, other));
  std::string found(some.size(), ' ');
  EXPECT_TRUE(file->read(100'000, found));
  EXPECT_EQ(found, some);
  found.resize(other.size());
  EXPECT_TRUE(file->read(0, found));
  EXPECT_EQ(found, other);
  std::array<char, 2> beyond{};
  EXPECT_FALSE(file->read(169'999, beyond));
}

TEST(ScratchFile, NeedsADiskWithRoom) {
  EXPECT_FALSE(ScratchFile::make(1, "/no/such/folder"));
  EXPECT_FALSE(ScratchFile::make(std::uint64_t{1} << 62, disk()));
  if (std::filesystem::is_directory("/dev/shm")) {
    EXPECT_FALSE(ScratchFile::make(1, "/dev/shm")) << "memory";
  }
}

TEST(ScratchFile, HasNoName) {
  const TemporaryFolder folder;
  const auto file = ScratchFile::make(1, folder.path());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace hybrid::testing
