#pragma once
#include <span>
#include <string>
#include <string_view>

namespace hybrid::io {

// LZF (liblzf, M. Lehmann), the compression of PCD's binary_compressed. Fills `output` exactly. Returns an
// empty string, or what is wrong and at which byte of `input`; never reads or writes outside either.
std::string decompress_lzf(std::string_view input, std::span<char> output);

// No valid stream expands more: a long match takes 3 bytes and gives at most 264.
inline constexpr std::size_t kLzfLargestExpansion = 88;

}  // namespace hybrid::io
