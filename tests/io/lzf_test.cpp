#include "io/pcd/lzf.hpp"

#include <gtest/gtest.h>

#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

// In memory and, the same, in pieces from a file.
std::string expand(const std::string& input, std::size_t size, std::string& output) {
  output.assign(size, '?');
  const std::string problem = io::decompress_lzf(input, output);
  const ScanFolder folder;
  const io::InputFile file(folder.write("a.lzf", "head" + input));
  std::string pieces;
  EXPECT_EQ(io::decompress_lzf(file, 4, input.size(), size,
                               [&](std::span<const char> piece) {
                                 pieces.append(piece.data(), piece.size());
                                 return true;
                               }),
            problem);
  if (problem.empty()) {
    EXPECT_EQ(pieces, output);
  }
  return problem;
}

TEST(Lzf, LiteralsShortAndLongMatches) {
  std::string output;
  // "abc", then 4 bytes from 3 back (overlapping what it makes), then 9 + 20 bytes from 1 back.
  EXPECT_EQ(expand(std::string("\x02"
                               "abc"
                               "\x40\x02"
                               "\xe0\x14\x00",
                               9),
                   36, output),
            "");
  EXPECT_EQ(output, "abcabca" + std::string(29, 'a'));
  EXPECT_EQ(expand("", 0, output), "");
}

TEST(Lzf, FarMatch) {
  std::string output;
  const std::string first = "far away" + std::string(24, '.');
  std::string input = lzf_literals(first);
  std::string expected = first;
  for (int i = 0; i < 255; ++i) {
    input += lzf_literals(std::string(32, '-'));
    expected += std::string(32, '-');
  }
  input += "\xdf\xff";  // 8 bytes from 8192 back
  EXPECT_EQ(expand(input, expected.size() + 8, output), "");
  EXPECT_EQ(output, expected + "far away");
}

// Beyond what is read and made at a time, with matches across the seams.
TEST(Lzf, ManyPieces) {
  std::string input = lzf_literals("0123456789abcdefghijklmnopqrstuv"),
              expected = "0123456789abcdefghijklmnopqrstuv";
  unsigned state = 1;
  while (expected.size() < (20u << 20) || input.size() < (5u << 20)) {
    state = state * 1664525 + 1013904223;
    const std::size_t length = 3 + (state >> 24) % 262,
                      distance = 1 + (state >> 8) % std::min<std::size_t>(8192, expected.size());
    input += static_cast<char>((length < 9 ? length - 2 : 7) << 5 | (distance - 1) >> 8);
    if (length >= 9) input += static_cast<char>(length - 9);
    input += static_cast<char>((distance - 1) & 255);
    for (std::size_t i = 0; i < length; ++i) expected += expected[expected.size() - distance];
    const std::string some = std::to_string(state);
    input += lzf_literals(some);
    expected += some;
  }
  std::string output;
  EXPECT_EQ(expand(input, expected.size(), output), "");
  EXPECT_EQ(output, expected);
  EXPECT_TRUE(holds(expand(input, expected.size() + 1, output), "uncompressed bytes, found"));
  EXPECT_TRUE(
      holds(expand(input, expected.size() - 1, output), "more data than announced at compressed byte"));
}

TEST(Lzf, DamageIsNamed) {
  const std::pair<std::string, const char*> damaged[] = {
      {std::string("\x05"
                   "abc",
                   4),
       "literal run beyond the end"},
      {std::string("\x02"
                   "abc"
                   "\x40",
                   5),
       "match beyond the end"},
      {std::string("\x02"
                   "abc"
                   "\xe0\x01",
                   6),
       "match beyond the end"},
      {std::string("\x02"
                   "abc"
                   "\x40\x03",
                   6),
       "match before the start"},
      {std::string("\x02"
                   "abc"
                   "\xe0\xff\x02",
                   7),
       "more data than announced"},
      {std::string("\x09"
                   "abcdefghij",
                   11),
       "more data than announced"},
      {std::string("\x02"
                   "abc",
                   4),
       "expected 8 uncompressed bytes, found 3"},
  };
  for (const auto& [input, part] : damaged) {
    std::string output;
    const std::string message = expand(input, 8, output);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace hybrid::testing
