#include "io/pcd/lzf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace hybrid::io {
namespace {

constexpr std::size_t kLongestCode = 33, kLongestMatch = 264, kFarthest = 8192;

class LzfDecoder {
 public:
  LzfDecoder(std::uint64_t input_bytes, std::uint64_t output_bytes)
      : input_left_(input_bytes), output_left_(output_bytes) {}

  std::size_t end() const { return end_; }  // of the output, after the last run()
  std::uint64_t input_left() const { return input_left_; }
  std::uint64_t output_left() const { return output_left_; }

  // Decodes what has not been taken yet, `input` on, behind what output holds to `out`: the last kFarthest
  // bytes at least, or all of them. Stops before what might not lie or fit in either, where more is to come.
  // Returns what is wrong.
  //
  // A control byte below 32 is followed by control + 1 literal bytes. Otherwise its upper 3 bits + 2 are the
  // length of a match (7: one more length byte follows), its lower 5 bits and the next byte the distance - 1.
  std::string run(std::string_view input, std::span<char> output, std::size_t out) {
    const std::size_t least_input = input.size() < input_left_ ? kLongestCode : 1,
                      least_room = output.size() - out < output_left_ ? kLongestMatch : 0;
    const std::size_t begin = out;
    std::size_t in = 0;
    const auto damaged = [&](const char* what) {
      end_ = out;
      return fmt::format("{} at compressed byte {}", what, before_ + in);
    };
    while (input.size() - in >= least_input && output.size() - out >= least_room) {
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
    before_ += in;
    input_left_ -= in;
    output_left_ -= out - begin;
    end_ = out;
    return {};
  }

 private:
  std::uint64_t before_ = 0, input_left_, output_left_;
  std::size_t end_ = 0;
};

std::string too_few(std::uint64_t expected, std::uint64_t missing) {
  if (missing == 0) return {};
  return fmt::format("expected {} uncompressed bytes, found {}", expected, expected - missing);
}

}  // namespace

std::string decompress_lzf(std::string_view input, std::span<char> output, std::size_t* produced) {
  LzfDecoder decoder(input.size(), output.size());
  std::string damage = decoder.run(input, output, 0);
  if (produced) *produced = decoder.end();
  return damage.empty() ? too_few(output.size(), decoder.output_left()) : damage;
}

std::string decompress_lzf(const InputFile& file, std::uint64_t offset, std::uint64_t bytes,
                           std::uint64_t expanded, const std::function<bool(std::span<const char>)>& take) {
  constexpr std::size_t kPiece = 1 << 20;
  LzfDecoder decoder(bytes, expanded);
  std::vector<char> input, output(kFarthest + std::min<std::uint64_t>(expanded, 4 * kPiece));
  for (std::size_t kept = 0; decoder.input_left() > 0;) {  // of the output that was taken, before the next
    input.resize(std::min<std::uint64_t>(decoder.input_left(), kPiece));
    file.read(offset + bytes - decoder.input_left(), input);
    const std::size_t room = std::min<std::uint64_t>(output.size() - kept, decoder.output_left());
    const std::string damage =
        decoder.run({input.data(), input.size()}, std::span(output).first(kept + room), kept);
    if (!damage.empty()) return damage;
    const std::size_t end = decoder.end();
    if (!take(std::span(output).subspan(kept, end - kept))) return {};
    const std::size_t next = std::min(end, kFarthest);
    std::copy(output.begin() + static_cast<std::ptrdiff_t>(end - next),
              output.begin() + static_cast<std::ptrdiff_t>(end), output.begin());
    kept = next;
  }
  return too_few(expanded, decoder.output_left());
}

}  // namespace hybrid::io
