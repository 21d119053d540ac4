#include "io/input_file.hpp"

#include <gtest/gtest.h>

#include "io/files.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::testing {
namespace {

constexpr std::size_t kMiB = 1 << 20;

std::string numbered_bytes(std::size_t count) {
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>(i * 2654435761u >> 13);
  return bytes;
}

TEST(InputFile, GivesTheSameBytesInAnyOrder) {
  const TemporaryFolder folder;
  const std::string bytes = numbered_bytes(3 * kMiB + 17);
  io::InputFile file(folder.write("a.bin", bytes));
  ASSERT_EQ(file.size(), bytes.size());
  for (const std::size_t at :
       {std::size_t{0}, 2 * kMiB, kMiB - 3, kMiB, 5 * kMiB / 2, bytes.size() - 8, std::size_t{1}})
    for (const std::size_t count : {1, 8})
      EXPECT_EQ(std::string(file.at(at, count), count), bytes.substr(at, count));
  EXPECT_EQ(std::string(file.at(5, 2 * kMiB), 2 * kMiB), bytes.substr(5, 2 * kMiB));  // more than a window
  EXPECT_EQ(file.ahead(bytes.size() - 3, 100), bytes.substr(bytes.size() - 3));
  EXPECT_EQ(file.ahead(bytes.size(), 100), "");
  std::string copy(2 * kMiB, '\0');
  file.read(kMiB, copy);
  EXPECT_EQ(copy, bytes.substr(kMiB, 2 * kMiB));
}

TEST(InputFile, BytesBeyondTheEndAreRefusedWithoutMemoryForThem) {
  const TemporaryFolder folder;
  io::InputFile file(folder.write("a.bin", "12345"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { file.at(2, 1'000'000'000'000); }),
                    "byte 2: expected 1000000000000"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { file.at(6, 1); }), "byte 6"));
}

// A mapped file would end the program by SIGBUS here.
TEST(InputFile, ShortenedByAnotherProcessIsAnError) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.ptx", std::string(4 * kMiB, ' '));
  io::InputFile file(path);
  EXPECT_EQ(*file.at(0, 1), ' ');
  std::filesystem::resize_file(path, 3 * kMiB / 2);
  const std::string message = error_of(ErrorKind::input, [&] { file.at(kMiB + 5, 2 * kMiB); });
  EXPECT_TRUE(holds(message, path.string() + ": byte 1572864: expected 4194304 bytes"));
  EXPECT_TRUE(holds(message, "another process shortened it"));
  EXPECT_TRUE(holds(message, "read it again"));
  io::TextCursor text(file);
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { text.skip_blank_lines(); }), "shortened"));
}

TEST(InputFile, FindsWhatIsNotZero) {
  const TemporaryFolder folder;
  std::string bytes(3 * kMiB, '\0');
  bytes[2 * kMiB + 1] = 'x';
  io::InputFile file(folder.write("a.bin", bytes));
  EXPECT_FALSE(file.only_zeros_from(0));
  EXPECT_FALSE(file.only_zeros_from(2 * kMiB + 1));
  EXPECT_TRUE(file.only_zeros_from(2 * kMiB + 2));
  EXPECT_TRUE(file.only_zeros_from(bytes.size()));
}

// Lines of every length across the windows' borders, each with another end.
TEST(TextCursor, LinesAcrossWindows) {
  const TemporaryFolder folder;
  const std::string ends[] = {"\n", "\r\n", "\r"};
  std::string text;
  std::vector<std::string> lines;
  for (std::size_t i = 0; text.size() < 3 * kMiB; ++i) {
    lines.push_back(std::string(i % 7 == 6 ? 70'000 + i : 1 + i % 97, static_cast<char>('a' + i % 26)));
    text += lines.back() + ends[i % 3];
  }
  for (std::size_t shift = 0; shift < 4; ++shift) {  // so that CR LF falls on a border at least once
    io::InputFile file(folder.write("lines.txt", std::string(shift, '#') + text));
    io::TextCursor cursor(file, shift);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      ASSERT_FALSE(cursor.at_end());
      ASSERT_EQ(cursor.line(), i + 1);
      ASSERT_EQ(cursor.next_line(), lines[i]);
      ASSERT_EQ(cursor.last_line_end(), ends[i % 3]);
    }
    EXPECT_TRUE(cursor.at_end());
    EXPECT_EQ(cursor.remaining(), 0u);
  }
}

// The LF of a CR LF is the first byte after the first window.
TEST(TextCursor, LineEndOnTheBorder) {
  const TemporaryFolder folder;
  io::InputFile file(folder.write("lines.txt", std::string(kMiB - 1, 'x') + "\r\n1 2\n"));
  io::TextCursor cursor(file);
  EXPECT_EQ(cursor.next_line().size(), kMiB - 1);
  std::vector<double> values;
  cursor.read_all_numbers(values);
  EXPECT_EQ(values, (std::vector<double>{1, 2}));
  EXPECT_EQ(cursor.line(), 3u);
  EXPECT_TRUE(cursor.at_end());
}

TEST(TextCursor, ALineWithoutEndIsNotReadWhole) {
  const TemporaryFolder folder;
  io::InputFile file(folder.write("binary.ply", "ply\n" + std::string(5 * kMiB, 'x')));
  io::TextCursor cursor(file, 0, 1, kMiB);
  EXPECT_EQ(cursor.next_line(), "ply");
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { cursor.next_line(); }), "line 2: expected a line of at most"));
}

}  // namespace
}  // namespace hybrid::testing
