#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hybrid::io {

// Columns of small whole numbers as a sample file stores them: folded so that small negative ones are small
// too, split into bytes of one weight (most of the upper ones are zero), each compressed by zstd.

// 0, -1, 1, -2, 2 ... as 0, 1, 2, 3, 4 ...; differences are taken modulo 2^32, so every one folds and
// unfolds.
constexpr std::uint32_t fold(std::uint32_t difference) {
  return (difference << 1) ^ (0u - (difference >> 31));
}
constexpr std::uint32_t unfold(std::uint32_t folded) {
  return (folded >> 1) ^ (0u - (folded & 1));
}

// Appends the column and returns how many bytes that took.
std::size_t append_column(std::span<const std::uint32_t> values, std::string& bytes);

// Takes columns from the front of a block. `place` names file and block for errors.
class ColumnReader {
 public:
  ColumnReader(std::string_view bytes, std::string place) : bytes_(bytes), place_(std::move(place)) {}

  // Exactly `count` values. Throws ErrorKind::input: cut short, damaged, another count.
  std::vector<std::uint32_t> take(std::size_t count);
  // Throws when something is left over.
  void finish() const;

 private:
  std::uint32_t take_number(std::size_t bytes);

  std::string_view bytes_;
  std::string place_;
};

// Any bytes, and back again; `most` bounds what is allocated. decompress() throws ErrorKind::input naming
// `place`.
std::string compress(std::string_view bytes);
std::string decompress(std::string_view bytes, std::size_t most, const std::string& place);

}  // namespace hybrid::io
