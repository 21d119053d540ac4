#include "io/output.hpp"

#include <gtest/gtest.h>

#include <set>

#include "io/files.hpp"

namespace hybrid::io {
namespace {
namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

TEST(output, creates_parents_and_leaves_nothing_else) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a/b/c.json", "{}\n");
  EXPECT_EQ(bytes_of(folder.path() / "a/b/c.json"), "{}\n");
  EXPECT_EQ(names_in(folder.path() / "a/b"), std::set<std::string>{"c.json"});
}

TEST(output, replaces_whole_files) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a.txt", "a longer old text");
  write_text(folder.path() / "a.txt", "new");
  EXPECT_EQ(bytes_of(folder.path() / "a.txt"), "new");
}

TEST(output, writes_beside_the_target_with_its_extension) {
  const TemporaryFolder folder;
  write_atomically(folder.path() / "a.exr", [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.parent_path(), folder.path());
    EXPECT_EQ(temporary.extension(), ".exr");
    EXPECT_FALSE(fs::exists(folder.path() / "a.exr"));
    std::ofstream(temporary) << "x";
  });
  EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"a.exr"});
}

TEST(output, a_failed_write_leaves_the_old_file_and_nothing_half_written) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a.txt", "old");
  const auto half = [](const fs::path& temporary) {
    std::ofstream(temporary) << "half";
    throw std::runtime_error("library stopped");
  };
  const std::string message =
      error_of(ErrorKind::failed, [&] { write_atomically(folder.path() / "a.txt", half); });
  EXPECT_TRUE(holds(message, (folder.path() / "a.txt").string()));
  EXPECT_TRUE(holds(message, "library stopped"));
  EXPECT_EQ(bytes_of(folder.path() / "a.txt"), "old");
  EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"a.txt"});
}

TEST(output, an_error_of_ours_keeps_its_kind) {
  const TemporaryFolder folder;
  error_of(ErrorKind::input,
           [&] { write_atomically(folder.path() / "a", [](const fs::path&) { fail_input("bad face"); }); });
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(output, a_writer_that_writes_nothing_is_an_error) {
  const TemporaryFolder folder;
  error_of(ErrorKind::failed, [&] { write_atomically(folder.path() / "a", [](const fs::path&) {}); });
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(output, unwritable_folders) {
  const TemporaryFolder folder;
  folder.write("file", "x");
  EXPECT_TRUE(holds(error_of(ErrorKind::failed, [&] { write_text(folder.path() / "file/a.txt", "x"); }),
                    (folder.path() / "file").string() + ": expected a writable output folder"));
  fs::create_directories(folder.path() / "closed");
  fs::permissions(folder.path() / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  if (access((folder.path() / "closed").c_str(), W_OK) == 0) GTEST_SKIP() << "this user may write everywhere";
  EXPECT_TRUE(holds(error_of(ErrorKind::failed, [&] { write_text(folder.path() / "closed/a.txt", "x"); }),
                    "expected a writable output folder"));
}

TEST(output, a_target_that_is_a_folder_is_an_error) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "a.txt/inside");
  EXPECT_TRUE(holds(error_of(ErrorKind::failed, [&] { write_text(folder.path() / "a.txt", "x"); }), "a.txt"));
  EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"a.txt"});
}

TEST(output, reading) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\r\n", 5);
  EXPECT_EQ(read_text(folder.write("a", bytes)), bytes);
  EXPECT_EQ(read_text(folder.write("empty", "")), "");
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_text(folder.path() / "none"); }), "no such file"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_text(folder.path()); }), "found a folder"));
}

// Reference values of XXH3-128 from the xxhsum tool.
TEST(output, fingerprints) {
  const TemporaryFolder folder;
  const auto empty = fingerprint(folder.write("empty", ""));
  EXPECT_EQ(empty.bytes, 0u);
  EXPECT_EQ(empty.xxh3, "99aa06d3014798d86001c324468d497f");
  const std::string large(3 * (1 << 20) + 17, 'x');  // more than one block
  EXPECT_EQ(fingerprint(folder.write("a", large)).bytes, large.size());
  EXPECT_EQ(fingerprint(folder.write("a", large)).xxh3, fingerprint(folder.write("b", large)).xxh3);
  EXPECT_NE(fingerprint(folder.write("a", large)).xxh3, fingerprint(folder.write("b", large + "y")).xxh3);
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { fingerprint(folder.path() / "none"); }), "no such file"));
}

}  // namespace
}  // namespace hybrid::io
