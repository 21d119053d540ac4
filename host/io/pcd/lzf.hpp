#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "io/input_file.hpp"

namespace hybrid::io {

// LZF (liblzf, M. Lehmann), the compression of PCD's binary_compressed. Fills `output` exactly. Returns an
// empty string, or what is wrong and at which byte of `input`; never reads or writes outside either.
// `produced`: how many bytes of `output` are filled when the data is damaged.
std::string decompress_lzf(std::string_view input, std::span<char> output, std::size_t* produced = nullptr);

// The same of `bytes` bytes of a file from `offset` on, in memory for some MiB: take(piece) gets the
// `expanded` bytes in pieces, and ends it by returning false.
std::string decompress_lzf(const InputFile& file, std::uint64_t offset, std::uint64_t bytes,
                           std::uint64_t expanded, const std::function<bool(std::span<const char>)>& take);

// No valid stream expands more: a long match takes 3 bytes and gives at most 264.
inline constexpr std::size_t kLzfLargestExpansion = 88;

}  // namespace hybrid::io
