#include "io/sample_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hybrid::io {
namespace {

template <typename Number>
void append(std::string& text, Number value) {
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
    if (static_cast<float>(whole / power - origin) == relative) return append(text, whole / power);
  }
  append(text, value);
}

// Of whole steps the fewest decimals that tell one from the next.
void append_step(std::string& text, double value, double step) {
  constexpr double kClose = 1e-4;  // steps
  double power = 1;
  for (int decimals = 0; decimals <= 15; ++decimals, power *= 10) {
    const double whole = std::round(value * power);
    if (std::abs(whole) > 0x1p53) break;
    if (std::abs(whole / power - value) <= kClose * step) return append(text, whole / power + 0.0);
  }
  append(text, value);
}

}  // namespace

void append_number(std::string& text, double value) {
  append(text, value);
}

void append_number(std::string& text, float value) {
  append(text, value);
}

bool is_return(const std::array<float, 3>& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

void append_point(std::string& text, const Scan& scan, std::size_t sample) {
  const auto& point = scan.points[sample];
  if (!is_return(point)) {
    text += "0 0 0";
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += ' ';
    if (!scan.exact.empty())
      append_step(text, scan.exact[sample][static_cast<std::size_t>(axis)],
                  scan.steps ? scan.steps->scale[axis] : 0.0);
    else if (scan.origin.isZero())
      append(text, point[static_cast<std::size_t>(axis)]);
    else
      append_coordinate(text, scan.origin[axis], point[static_cast<std::size_t>(axis)]);
  }
}

void append_colour(std::string& text, const std::array<std::uint8_t, 3>& rgb) {
  for (const std::uint8_t value : rgb) {
    text += ' ';
    append(text, static_cast<int>(value));
  }
}

std::size_t laid_out(const Scan& scan) {
  if (!scan.organised()) return scan.points.size();
  if (!scan.node.empty())
    return scan.node.size() - static_cast<std::size_t>(std::ranges::count(scan.node, Scan::kNoNode));
  return static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols);
}

GridSamples::GridSamples(const Scan& scan) : scan_(scan) {
  if (scan.node.empty()) return;
  sample_.assign(static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols),
                 Scan::kNoNode);
  for (std::size_t i = 0; i < scan.node.size(); ++i)
    if (scan.node[i] != Scan::kNoNode) sample_[scan.node[i]] = static_cast<std::uint32_t>(i);
}

std::uint32_t GridSamples::at(int row, int col) const {
  if (sample_.empty()) return static_cast<std::uint32_t>(scan_.grid_index(row, col));
  return sample_[static_cast<std::size_t>(row) * static_cast<std::size_t>(scan_.grid_cols) +
                 static_cast<std::size_t>(col)];
}

std::vector<std::uint32_t> returns_of(const Scan& scan) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (is_return(scan.points[i])) indices.push_back(static_cast<std::uint32_t>(i));
  return indices;
}

}  // namespace hybrid::io
