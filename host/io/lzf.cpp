#include "io/lzf.hpp"

#include <fmt/format.h>

#include <cstring>

namespace hybrid::io {

// A control byte below 32 is followed by control + 1 literal bytes. Otherwise its upper 3 bits + 2 are the
// length of a match (7: one more length byte follows), its lower 5 bits and the next byte the distance - 1.
std::string decompress_lzf(std::string_view input, std::span<char> output, std::size_t* produced) {
  std::size_t in = 0, out = 0;
  std::size_t nowhere = 0;
  std::size_t& filled = produced ? *produced : nowhere;
  filled = 0;
  const auto damaged = [&](const char* what) { return fmt::format("{} at compressed byte {}", what, in); };
  while (in < input.size()) {
    filled = out;
    const auto control = static_cast<unsigned char>(input[in++]);
    if (control < 32) {
      const std::size_t length = control + 1u;
      if (length > input.size() - in) return damaged("literal run beyond the end");
      if (length > output.size() - out) return damaged("more data than announced");
      std::memcpy(output.data() + out, input.data() + in, length);
      in += length;
      out += length;
      continue;
    }
    std::size_t length = (control >> 5) + 2u;
    if (input.size() - in < (length == 9 ? 2u : 1u)) return damaged("match beyond the end");
    if (length == 9) length += static_cast<unsigned char>(input[in++]);
    const std::size_t distance = ((control & 31u) << 8) + static_cast<unsigned char>(input[in++]) + 1u;
    if (distance > out) return damaged("match before the start of the data");
    if (length > output.size() - out) return damaged("more data than announced");
    // Byte by byte: a match may overlap what it produces.
    for (std::size_t i = 0; i < length; ++i, ++out) output[out] = output[out - distance];
  }
  filled = out;
  if (out != output.size())
    return fmt::format("expected {} uncompressed bytes, found {}", output.size(), out);
  return {};
}

}  // namespace hybrid::io
