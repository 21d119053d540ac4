#include "batch/picture_marks.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace hybrid::batch {
namespace {

// Rows from the top, the leftmost cell in the highest of five bits.
constexpr std::uint8_t kDigits[10][7] = {{14, 17, 19, 21, 25, 17, 14}, {4, 12, 4, 4, 4, 4, 14},
                                         {14, 17, 1, 2, 4, 8, 31},     {31, 2, 4, 2, 1, 17, 14},
                                         {2, 6, 10, 18, 31, 2, 2},     {31, 16, 30, 1, 1, 17, 14},
                                         {6, 8, 16, 30, 17, 17, 14},   {31, 1, 2, 4, 8, 8, 8},
                                         {14, 17, 17, 14, 17, 17, 14}, {14, 17, 17, 15, 1, 2, 12}};
constexpr int kCols = 5, kRows = 7;

void put(Image8& picture, int x, int y, const Ink& ink) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  std::copy(ink.begin(), ink.end(), picture.at(x, y));
}

}  // namespace

void draw_line(Image8& picture, const Vec2& from, const Vec2& to, const Ink& ink, int width) {
  const int steps = static_cast<int>(std::ceil((to - from).cwiseAbs().maxCoeff()));
  if (!(steps >= 0) || steps > 1 << 16) return;
  for (int k = 0; k <= steps; ++k) {
    const Vec2 p = from + (to - from) * (steps ? static_cast<double>(k) / steps : 0);
    for (int dy = 0; dy < width; ++dy)
      for (int dx = 0; dx < width; ++dx)
        put(picture, static_cast<int>(std::lround(p.x())) + dx, static_cast<int>(std::lround(p.y())) + dy,
            ink);
  }
}

void draw_disc(Image8& picture, const Vec2& centre, int radius, const Ink& ink) {
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      if (x * x + y * y <= radius * radius)
        put(picture, static_cast<int>(std::lround(centre.x())) + x,
            static_cast<int>(std::lround(centre.y())) + y, ink);
}

NumberSize number_size(int number, int cell) {
  const int digits = static_cast<int>(std::to_string(number).size());
  return {(digits * (kCols + 1) - 1) * cell, kRows * cell};
}

void draw_number(Image8& picture, int x, int y, int number, int cell, const Ink& ink) {
  for (const char c : std::to_string(number)) {
    if (c < '0' || c > '9') continue;
    for (int row = 0; row < kRows; ++row)
      for (int col = 0; col < kCols; ++col)
        if (kDigits[c - '0'][row] >> (kCols - 1 - col) & 1)
          for (int dy = 0; dy < cell; ++dy)
            for (int dx = 0; dx < cell; ++dx) put(picture, x + col * cell + dx, y + row * cell + dy, ink);
    x += (kCols + 1) * cell;
  }
}

}  // namespace hybrid::batch
