#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/image.hpp"
#include "geometry/vectors.hpp"

namespace hybrid::batch {

using Ink = std::array<std::uint8_t, 3>;
inline constexpr Ink kPaper = {255, 255, 255};

// Marks on 3-channel pictures; what lies outside is left out.
void draw_line(Image8& picture, const Vec2& from, const Vec2& to, const Ink& ink, int width = 1);
void draw_disc(Image8& picture, const Vec2& centre, int radius, const Ink& ink);

// A whole number in digits of 5 x 7 cells of `cell` pixels, its top left corner at (x, y).
struct NumberSize {
  int width, height;
};
NumberSize number_size(int number, int cell);
void draw_number(Image8& picture, int x, int y, int number, int cell, const Ink& ink);
// A text of digits, minus signs, blanks and the letters of "behind", "in front of the face" and "mm"; others
// are left blank. The same cells.
void draw_text(Image8& picture, int x, int y, const std::string& text, int cell, const Ink& ink);
int text_width(const std::string& text, int cell);

// Numbers beside points, each on a patch of paper; those that would cover an earlier one are left out.
class NumberLabels {
 public:
  NumberLabels(Image8& picture, int cell, const Ink& ink) : picture_(picture), cell_(cell), ink_(ink) {}
  void add(const Vec2& at, int number);

 private:
  Image8& picture_;
  int cell_;
  Ink ink_;
  std::vector<std::array<int, 4>> boxes_;
};

}  // namespace hybrid::batch
