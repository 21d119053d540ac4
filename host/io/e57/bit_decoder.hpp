#pragma once
#include <cstdint>
#include <span>

namespace hybrid::io {

// How many bytes after the last value's own unpack_bits() may read.
inline constexpr std::size_t kBitSlack_bytes = 16;

// Unpacks values of `width` bits (1 to 64), least significant bit first, one after the other from bit
// `first_bit` of `bytes` on: to[i] = minimum + value i, in the arithmetic of 64-bit words.
void unpack_bits(const char* bytes, std::uint64_t first_bit, int width, std::int64_t minimum,
                 std::span<std::int64_t> to);

}  // namespace hybrid::io
