#pragma once
#include <span>
#include <string>
#include <string_view>

namespace hybrid::io {

// LZF (liblzf, M. Lehmann), the compression of PCD's binary_compressed. Fills `output` exactly. Returns an
// empty string, or what is wrong and at which byte of `input`; never reads or writes outside either.
// `produced`: how many bytes of `output` are filled when the data is damaged.
std::string decompress_lzf(std::string_view input, std::span<char> output, std::size_t* produced = nullptr);

// No valid stream expands more: a long match takes 3 bytes and gives at most 264.
inline constexpr std::size_t kLzfLargestExpansion = 88;

}  // namespace hybrid::io
