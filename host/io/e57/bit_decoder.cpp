#include "io/e57/bit_decoder.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "io/e57/little_endian.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t mask_of(int width) {
  return width == 64 ? ~0ull : (1ull << width) - 1;
}

// One value anywhere: a word holds 57 bits behind any bit of its first byte, the ninth byte has the rest.
std::uint64_t one(const char* bytes, std::uint64_t bit, int width) {
  const char* at = bytes + (bit >> 3);
  const int shift = static_cast<int>(bit & 7);
  std::uint64_t value = load<std::uint64_t>(at) >> shift;
  if (shift + width > 64)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(at[8])) << (64 - shift);
  return value & mask_of(width);
}

// Eight values fill `Width` bytes: with the width known, every address and shift below is a constant.
template <int Width>
void eights(const char* bytes, std::size_t count, std::uint64_t minimum, std::int64_t* to) {
  for (std::size_t i = 0; i < count; ++i, bytes += Width, to += 8)
    [&]<int... K>(std::integer_sequence<int, K...>) {
      const auto value = [&]<int Bit>() {
        constexpr int kShift = Bit % 8;
        std::uint64_t word = load<std::uint64_t>(bytes + Bit / 8) >> kShift;
        if constexpr (kShift + Width > 64)
          word |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[Bit / 8 + 8])) << (64 - kShift);
        return static_cast<std::int64_t>((word & mask_of(Width)) + minimum);
      };
      ((to[K] = value.template operator()<K * Width>()), ...);
    }
  (std::make_integer_sequence<int, 8>{});
}

using Eights = void (*)(const char*, std::size_t, std::uint64_t, std::int64_t*);

template <int... W>
constexpr std::array<Eights, sizeof...(W)> table(std::integer_sequence<int, W...>) {
  return {&eights<W + 1>...};
}

constexpr auto kEights = table(std::make_integer_sequence<int, 64>{});

}  // namespace

void unpack_bits(const char* bytes, std::uint64_t first_bit, int width, std::int64_t minimum,
                 std::span<std::int64_t> to) {
  const auto base = static_cast<std::uint64_t>(minimum), step = static_cast<std::uint64_t>(width);
  std::size_t i = 0;
  // Values one by one up to the start of a byte, if the width ever leads to one within eight.
  const auto single = [&](std::size_t end) {
    for (; i < end; ++i) to[i] = static_cast<std::int64_t>(one(bytes, first_bit + i * step, width) + base);
  };
  std::size_t lead = 0;
  while (lead < 8 && (first_bit + lead * step) % 8 != 0) ++lead;
  if (lead < 8 && lead < to.size()) {
    single(lead);
    const std::size_t groups = (to.size() - i) / 8;
    kEights[static_cast<std::size_t>(width - 1)](bytes + (first_bit + i * step) / 8, groups, base, &to[i]);
    i += 8 * groups;
  }
  single(to.size());
}

}  // namespace hybrid::io
