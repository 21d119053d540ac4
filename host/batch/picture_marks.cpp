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

struct Glyph {
  char letter;
  std::uint8_t rows[kRows];
};
constexpr Glyph kLetters[] = {{'a', {0, 0, 14, 1, 15, 17, 15}},    {'b', {16, 16, 30, 17, 17, 17, 30}},
                              {'c', {0, 0, 14, 16, 16, 17, 14}},   {'d', {1, 1, 15, 17, 17, 17, 15}},
                              {'e', {0, 0, 14, 17, 31, 16, 14}},   {'f', {6, 8, 28, 8, 8, 8, 8}},
                              {'h', {16, 16, 22, 25, 17, 17, 17}}, {'i', {4, 0, 12, 4, 4, 4, 14}},
                              {'m', {0, 0, 26, 21, 21, 21, 21}},   {'n', {0, 0, 22, 25, 17, 17, 17}},
                              {'o', {0, 0, 14, 17, 17, 17, 14}},   {'r', {0, 0, 22, 25, 16, 16, 16}},
                              {'s', {0, 0, 15, 16, 14, 1, 30}},    {'t', {8, 8, 28, 8, 8, 9, 6}},
                              {'-', {0, 0, 0, 14, 0, 0, 0}}};

const std::uint8_t* rows_of(char c) {
  if (c >= '0' && c <= '9') return kDigits[c - '0'];
  for (const Glyph& glyph : kLetters)
    if (glyph.letter == c) return glyph.rows;
  return nullptr;
}

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
  draw_text(picture, x, y, std::to_string(number), cell, ink);
}

void draw_text(Image8& picture, int x, int y, const std::string& text, int cell, const Ink& ink) {
  for (const char c : text) {
    const std::uint8_t* rows = rows_of(c);
    for (int row = 0; rows != nullptr && row < kRows; ++row)
      for (int col = 0; col < kCols; ++col)
        if (rows[row] >> (kCols - 1 - col) & 1)
          for (int dy = 0; dy < cell; ++dy)
            for (int dx = 0; dx < cell; ++dx) put(picture, x + col * cell + dx, y + row * cell + dy, ink);
    x += (kCols + 1) * cell;
  }
}

int text_width(const std::string& text, int cell) {
  return (static_cast<int>(text.size()) * (kCols + 1) - 1) * cell;
}

void NumberLabels::add(const Vec2& at, int number) {
  const auto size = number_size(number, cell_);
  const int x = static_cast<int>(at.x()) + 7, y = static_cast<int>(at.y()) - size.height - 5;
  const std::array<int, 4> box = {x - 3, y - 3, x + size.width + 3, y + size.height + 3};
  for (const auto& other : boxes_)
    if (box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3]) return;
  boxes_.push_back(box);
  for (int row = box[1]; row < box[3]; ++row)
    draw_line(picture_, Vec2(box[0], row), Vec2(box[2] - 1, row), kPaper);
  draw_number(picture_, x, y, number, cell_, ink_);
}

}  // namespace hybrid::batch
