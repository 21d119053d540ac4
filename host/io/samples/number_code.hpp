#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

namespace hybrid::io {

// Floats as whole numbers of which neighbouring ones mean neighbouring values, exactly: multiples of a
// decimal step where all values are such (what scanners and text files store), else the floats' own bits in
// ascending order. Differences are taken modulo 2^32.
class NumberCode {
 public:
  NumberCode() = default;
  explicit NumberCode(double step) : step_(step) {}  // 0: bits
  double step() const { return step_; }

  bool holds(float value) const {
    return std::bit_cast<std::uint32_t>(decode(encode(value))) == std::bit_cast<std::uint32_t>(value);
  }

  std::uint32_t encode(double value) const {
    if (step_ > 0)
      return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::llround(bounded(value / step_))));
    return encode_bits(static_cast<float>(value));
  }
  std::uint32_t encode(float value) const {
    return step_ > 0 ? encode(static_cast<double>(value)) : encode_bits(value);
  }

  float decode(std::uint32_t code) const {
    if (step_ > 0) return static_cast<float>(exact(code));
    return std::bit_cast<float>((code >> 31) != 0 ? code ^ 0x80000000u : ~code);
  }

 private:
  double exact(std::uint32_t code) const { return static_cast<std::int32_t>(code) * step_; }
  static double bounded(double multiple) {
    constexpr double kMost = 2147483647;
    return multiple < kMost ? (multiple > -kMost ? multiple : -kMost) : kMost;
  }
  static std::uint32_t encode_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits >> 31) != 0 ? ~bits : bits ^ 0x80000000u;
  }

  double step_ = 0;
};

}  // namespace hybrid::io
