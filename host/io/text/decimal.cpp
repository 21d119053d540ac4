#include "io/text/decimal.hpp"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace hybrid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the first digit is the lowest byte");

constexpr std::uint64_t kExactWhole = std::uint64_t{1} << 53;
constexpr unsigned kMostDigits = 18;  // that 64 bits hold
constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kWholePowersOfTen[] = {1,       10,        100,        1'000,      10'000,
                                               100'000, 1'000'000, 10'000'000, 100'000'000};

// A run of digits appended to `whole`, `count` counted up; false when 64 bits do not hold it.
bool take_digits(const char*& at, const char* end, std::uint64_t& whole, unsigned& count) {
  while (end - at >= 8) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, at, 8);
    bytes ^= 0x3030303030303030u;  // digits become 0 to 9, everything else larger
    const std::uint64_t others = ((bytes + 0x7676767676767676u) | bytes) & 0x8080808080808080u;
    const unsigned digits = others == 0 ? 8u : static_cast<unsigned>(std::countr_zero(others)) / 8;
    if (digits == 0) return true;
    bytes <<= 8 * (8 - digits);  // leading zeros
    bytes = 10 * bytes + (bytes >> 8);
    bytes = ((bytes & 0x000000ff000000ffu) * 0x000f424000000064u +
             ((bytes >> 16) & 0x000000ff000000ffu) * 0x0000271000000001u) >>
            32;
    count += digits;
    if (count > kMostDigits) return false;
    whole = whole * kWholePowersOfTen[digits] + bytes;
    at += digits;
    if (digits < 8) return true;
  }
  for (; at != end && static_cast<unsigned char>(*at - '0') <= 9; ++at) {
    if (++count > kMostDigits) return false;
    whole = 10 * whole + static_cast<unsigned char>(*at - '0');
  }
  return true;
}

// Sign, digits, point, digits and nothing that goes on with the number. nullptr: not decided here.
const char* parse_short(const char* at, const char* end, double& value) {
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t whole = 0;
  unsigned digits = 0, decimals = 0;
  // Before the point there are few, behind it most often as many as in the line before.
  for (; at != end && static_cast<unsigned char>(*at - '0') <= 9; ++at) {
    if (++digits > kMostDigits) return nullptr;
    whole = 10 * whole + static_cast<unsigned char>(*at - '0');
  }
  if (at != end && *at == '.') {
    ++at;
    const unsigned before = digits;
    if (!take_digits(at, end, whole, digits)) return nullptr;
    decimals = digits - before;
  }
  if (digits == 0 || whole > kExactWhole) return nullptr;
  if (at != end && (*at == 'e' || *at == 'E')) return nullptr;
  const double magnitude = static_cast<double>(whole) / kPowersOfTen[decimals];
  value = negative ? -magnitude : magnitude;
  return at;
}

}  // namespace

const char* parse_number(const char* at, const char* end, double& value) {
  if (const char* next = parse_short(at, end, value)) return next;
  if (end - at > 1 && *at == '+' && at[1] != '-') ++at;
  const auto [next, code] = std::from_chars(at, end, value);
  if (code == std::errc::result_out_of_range) {  // too small for double is 0; too large stays an error
    const std::string_view digits(at, static_cast<std::size_t>(next - at));
    if (digits.find("e-") == digits.npos && digits.find("E-") == digits.npos) return nullptr;
    value = 0;
    return next;
  }
  return code == std::errc{} ? next : nullptr;
}

}  // namespace hybrid::io
