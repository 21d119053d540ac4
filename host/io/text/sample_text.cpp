#include "io/text/sample_text.hpp"

#include <charconv>
#include <cmath>

namespace hybrid::io {
namespace {

template <typename Number>
void append_digits(std::string& text, Number value) {
  char digits[64];
  const auto [end, code] = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end);
}

// A whole number over a power of ten is the double nearest to that decimal, so this is what a reader gets.
void append_coordinate(std::string& text, double origin, float relative) {
  const double value = origin + static_cast<double>(relative);
  double power = 1;
  for (int decimals = 0; decimals <= 15; ++decimals, power *= 10) {
    const double whole = std::round(value * power);
    if (std::abs(whole) > 0x1p53) break;
    if (static_cast<float>(whole / power - origin) == relative) return append_digits(text, whole / power);
  }
  append_digits(text, value);
}

// Of whole steps the fewest decimals that tell one from the next.
void append_step(std::string& text, double value, double step) {
  constexpr double kClose = 1e-4;  // steps
  double power = 1;
  for (int decimals = 0; decimals <= 15; ++decimals, power *= 10) {
    const double whole = std::round(value * power);
    if (std::abs(whole) > 0x1p53) break;
    if (std::abs(whole / power - value) <= kClose * step) return append_digits(text, whole / power + 0.0);
  }
  append_digits(text, value);
}

}  // namespace

void append_number(std::string& text, double value) {
  append_digits(text, value);
}

void append_number(std::string& text, float value) {
  append_digits(text, value);
}

void append_point(std::string& text, const SampleBlock& block, std::size_t sample) {
  const Scan& scan = *block.scan;
  const auto& point = block.points[sample];
  if (!is_return(point)) {
    text += "0 0 0";
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += ' ';
    if (!block.exact.empty())
      append_step(text, block.exact[sample][static_cast<std::size_t>(axis)],
                  scan.steps ? scan.steps->scale[axis] : 0.0);
    else if (scan.origin.isZero())
      append_digits(text, point[static_cast<std::size_t>(axis)]);
    else
      append_coordinate(text, scan.origin[axis], point[static_cast<std::size_t>(axis)]);
  }
}

void append_colour(std::string& text, const std::array<std::uint8_t, 3>& rgb) {
  for (const std::uint8_t value : rgb) {
    text += ' ';
    append_digits(text, static_cast<int>(value));
  }
}

}  // namespace hybrid::io
