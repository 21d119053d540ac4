#include "io/lzf.hpp"

#include <gtest/gtest.h>

#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

std::string expand(const std::string& input, std::size_t size, std::string& output) {
  output.assign(size, '?');
  return io::decompress_lzf(input, output);
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
