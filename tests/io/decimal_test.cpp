// parse_number against std::from_chars, bit for bit, on millions of numbers.
#include "io/text/decimal.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <random>
#include <string>

namespace hybrid::io {
namespace {

// What both make of a text: how much of it is the number, and its bits.
::testing::AssertionResult agrees(const std::string& text) {
  const char *begin = text.data(), *end = begin + text.size();
  double expected = 0, found = 0;
  const auto [expected_end, code] = std::from_chars(begin, end, expected);
  const char* found_end = parse_number(begin, end, found);
  const bool refused = code == std::errc::invalid_argument;
  const bool same = refused ? found_end == nullptr
                            : found_end == expected_end && std::bit_cast<std::uint64_t>(found) ==
                                                               std::bit_cast<std::uint64_t>(expected);
  if (same) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\"" << text << "\": expected " << expected << ", found " << found;
}

class Texts {
 public:
  std::uint64_t below(std::uint64_t bound) { return random_() % bound; }
  std::string digits(std::uint64_t count) {
    std::string text;
    for (; count > 0; --count) text += static_cast<char>('0' + below(10));
    return text;
  }
  // Sign, digits, point, digits, and what may follow a number in a file.
  std::string decimal(std::uint64_t most_whole, std::uint64_t most_decimals) {
    static const std::string kAfter[] = {"", " ", "\n", "\t1", ",2", " 3.5 7", "\r\n123456789 "};
    std::string text;
    if (below(3) == 0) text.push_back('-');
    text += digits(below(most_whole + 1));
    if (below(8) != 0) text.append(1, '.').append(digits(below(most_decimals + 1)));
    return text + kAfter[below(std::size(kAfter))];
  }

 private:
  std::mt19937_64 random_{20041117};
};

TEST(Decimal, AsScansHoldThem) {
  Texts texts;
  for (int i = 0; i < 1'500'000; ++i) ASSERT_TRUE(agrees(texts.decimal(7, 8)));
}

TEST(Decimal, OfAnyLength) {
  Texts texts;
  for (int i = 0; i < 500'000; ++i) ASSERT_TRUE(agrees(texts.decimal(25, 30)));
}

TEST(Decimal, ShortestTextsOfRandomDoubles) {
  Texts texts;
  for (int i = 0; i < 500'000; ++i) {
    const auto value = std::bit_cast<double>(texts.below(~std::uint64_t{0}));
    if (value == value) {
      ASSERT_TRUE(agrees(fmt::format("{}", value)));
    }
    // Around 2^53, where whole numbers stop being exact, with the digits on either side of the point.
    std::string whole = std::to_string((std::uint64_t{1} << 53) - 500 + texts.below(1000));
    ASSERT_TRUE(agrees(whole.insert(texts.below(whole.size() + 1), 1, '.')));
  }
}

TEST(Decimal, OddOnes) {
  for (const char* text : {"",
                           "-",
                           ".",
                           "-.",
                           "1.",
                           ".5",
                           "-.5",
                           "-0",
                           "0.0",
                           "00012",
                           "1e5",
                           "1.5e-3",
                           "2E+2",
                           "1e",
                           "1.e1",
                           "nan",
                           "-nan",
                           "inf",
                           "-inf",
                           "infinity",
                           "0x10",
                           "1..2",
                           "1-2",
                           "--1",
                           "1.5x",
                           "12345678",
                           "123456789",
                           "12345678.12345678",
                           "0.00000000000000000000001",
                           "9007199254740993",
                           "900719925474099.3",
                           "18446744073709551616",
                           "1.0000000000000000000000000000000001",
                           "e5",
                           "x",
                           "/",
                           ":",
                           "1/",
                           "1:",
                           "\x80",
                           "1\xff\xff\xff\xff\xff\xff\xff\xff"})
    EXPECT_TRUE(agrees(text));
}

TEST(Decimal, WhatFromCharsDoesNotKnow) {
  double value = 1;
  const std::string plus = "+2.5", two = "+-2", tiny = "1e-400", huge = "1e400";
  EXPECT_EQ(parse_number(plus.data(), plus.data() + plus.size(), value), plus.data() + plus.size());
  EXPECT_EQ(value, 2.5);
  EXPECT_EQ(parse_number(two.data(), two.data() + two.size(), value), nullptr);
  EXPECT_EQ(parse_number(tiny.data(), tiny.data() + tiny.size(), value), tiny.data() + tiny.size());
  EXPECT_EQ(value, 0);
  EXPECT_EQ(parse_number(huge.data(), huge.data() + huge.size(), value), nullptr);
}

}  // namespace
}  // namespace hybrid::io
