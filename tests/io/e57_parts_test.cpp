#include <gtest/gtest.h>

#include <random>

#include "io/e57/bit_decoder.hpp"
#include "io/e57/bit_encoder.hpp"
#include "io/e57/crc32c.hpp"
#include "io/e57/streams.hpp"
#include "io/e57_scans.hpp"

namespace hybrid::testing {
namespace {

// "123456789" is the check value of every table of checksums; 32 zeros that of RFC 3720.
TEST(Crc32c, KnownValues) {
  for (const auto& sum : {io::crc32c, io::crc32c_by_tables}) {
    EXPECT_EQ(sum(std::string("123456789")), 0xE3069283u);
    EXPECT_EQ(sum(std::string(32, '\0')), 0x8A9136AAu);
    EXPECT_EQ(sum(std::string()), 0u);
  }
}

TEST(Crc32c, InstructionAndTablesAgreeAtEveryLengthAndAlignment) {
  std::mt19937 random(5);
  std::string bytes(1100, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  for (std::size_t start = 0; start < 9; ++start)
    for (std::size_t length = 0; length < 1030; length += length < 40 ? 1 : 97)
      ASSERT_EQ(io::crc32c(std::span(bytes).subspan(start, length)),
                io::crc32c_by_tables(std::span(bytes).subspan(start, length)))
          << start << " " << length;
}

// Bit by bit, the slowest way.
std::uint64_t naive(const std::vector<char>& bytes, std::size_t bit, int width) {
  std::uint64_t value = 0;
  for (int i = 0; i < width; ++i, ++bit)
    value |= static_cast<std::uint64_t>(bytes[bit / 8] >> (bit % 8) & 1) << i;
  return value;
}

TEST(BitDecoder, EveryWidthFromEveryBit) {
  std::mt19937_64 random(7);
  std::vector<char> bytes(64 * 40 / 8 + 40);
  for (char& c : bytes) c = static_cast<char>(random());
  for (int width = 1; width <= 64; ++width)
    for (std::size_t first = 0; first < 9; ++first)
      for (const std::size_t count : {1u, 7u, 8u, 9u, 35u}) {
        std::vector<std::int64_t> values(count);
        io::unpack_bits(bytes.data(), first, width, -3, values);
        for (std::size_t i = 0; i < count; ++i)
          ASSERT_EQ(static_cast<std::uint64_t>(values[i]),
                    naive(bytes, first + i * static_cast<std::size_t>(width), width) - 3)
              << width << " bits from bit " << first << ", value " << i;
      }
}

// A stream cut into parts of any lengths, empty ones included, gives the same values; with a part missing
// exactly the values that need it are lost.
TEST(Streams, ValuesCrossPartsAndGapsLoseNoMore) {
  std::mt19937 random(3);
  for (const int width : {1, 3, 11, 12, 24, 33, 57, 63, 64}) {
    const std::uint64_t half = 1ull << (width - 1);
    const io::E57Field wide =
        integer_field("f", -static_cast<std::int64_t>(half - 1) - 1, static_cast<std::int64_t>(half - 1));
    const std::size_t count = 500;
    const auto columns = random_columns({wide}, count);
    io::BitEncoder encoder(wide);
    encoder.append(columns.integers[0]);
    encoder.finish();
    std::vector<char> bytes = encoder.bytes();
    const std::size_t length = bytes.size();
    bytes.resize(length + io::kBitSlack_bytes);
    io::StreamParts parts;
    for (std::size_t at = 0; at < length;) {
      const std::size_t take = std::min<std::size_t>(random() % 14, length - at);
      if (take > 0) parts.push_back({at, &bytes[at], take});
      at += take;
    }
    std::vector<std::int64_t> values(count);
    std::vector<io::E57Records::Lost> lost;
    io::decode(wide, parts, 0, values, lost);
    EXPECT_EQ(values, columns.integers[0]) << width;
    EXPECT_TRUE(lost.empty());
    io::decode(wide, parts, 123, std::span(values).first(9), lost);
    EXPECT_TRUE(std::equal(values.begin(), values.begin() + 9, columns.integers[0].begin() + 123)) << width;

    const io::StreamPart missing = parts[parts.size() / 2];
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2));
    io::decode(wide, parts, 0, values, lost);
    ASSERT_FALSE(lost.empty()) << width;
    std::vector<bool> is_lost(count);
    for (const auto& range : lost)
      for (std::uint64_t i = range.first; i < range.end; ++i) is_lost[i] = true;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t w = static_cast<std::size_t>(width);
      const bool needs = i * w / 8 < missing.end() && ((i + 1) * w + 7) / 8 > missing.start;
      ASSERT_EQ(is_lost[i], needs) << width << " bits, value " << i;
      ASSERT_EQ(values[i], needs ? 0 : columns.integers[0][i]);
    }
  }
}

}  // namespace
}  // namespace hybrid::testing
