#include "surface/notices.hpp"

#include <algorithm>

#include "surface/lettering.hpp"
#include "surface/noise.hpp"

namespace synth {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines{""};
  for (char c : text) {
    if (c == '/')
      lines.emplace_back();
    else
      lines.back() += c;
  }
  return lines;
}

std::uint64_t key_of(const Decor& d) {
  std::uint64_t key = 5;
  for (char c : d.text) key = key * 977 + static_cast<std::uint64_t>(c);
  return key;
}

// Words of two to eight letters, `length` characters in all.
std::string made_up(std::uint64_t key, int line, int length) {
  std::string text;
  std::int64_t draw = 0;
  while (static_cast<int>(text.size()) < length) {
    const int word = 2 + static_cast<int>(7 * hash01(line, draw++, key));
    for (int k = 0; k < word; ++k)
      text += static_cast<char>('A' + static_cast<int>(26 * hash01(line, draw++, key)));
    text += ' ';
  }
  text.resize(static_cast<std::size_t>(length));
  return text;
}

// All of `lines` below each other, `share` of a line's pitch being letters.
double block(const std::vector<std::string>& lines, const Decor& d, double u, double v, double w,
             double share) {
  const double pitch = d.height_m * 0.86 / static_cast<double>(lines.size()), margin = 0.08 * d.width_m;
  double ink = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double bottom = d.height_m * 0.93 - pitch * (static_cast<double>(k) + 0.5 + share / 2);
    if (v < bottom - w || v > bottom + share * pitch + w) continue;
    ink =
        std::max(ink, lettering(lines[k], u - margin, v - bottom, d.width_m - 2 * margin, share * pitch, w));
  }
  return ink;
}

}  // namespace

Rgb notice(const Decor& d, double u, double v, double w) {
  static const Rgb paper = srgb(0xefe9d8), ink = srgb(0x1a1b20), red = srgb(0x9c2320);
  const double title = 0.16 * d.height_m, margin = 0.07 * d.width_m, top = 0.94 * d.height_m;
  if (v > top - title - w)
    return blend(paper, red,
                 lettering(d.text, u - margin, v - (top - title), d.width_m - 2 * margin, title, w));
  double height = 0.075 * d.height_m, base = top - title - 1.5 * height, mark = 0;
  for (int line = 0; base > 0.05 * d.height_m; ++line) {
    if (v > base - w && v < base + height + w) {
      const auto letters = static_cast<int>((d.width_m - 2 * margin) / (height * 6 / 7));
      mark = lettering(made_up(key_of(d), line, letters), u - margin, v - base, d.width_m - 2 * margin,
                       height, w);
    }
    height = std::max(0.86 * height, 0.006);
    base -= 1.6 * height;
  }
  return blend(paper, ink, mark);
}

Rgb plaque(const Decor& d, double u, double v, double w) {
  static const Rgb marble = srgb(0xd9d3c4), cut = srgb(0x3a352f), line = srgb(0x8a7a58);
  const double edge = std::min({u, v, d.width_m - u, d.height_m - v});
  Rgb colour = marble * (1 + 0.10 * fractal_noise(u + 3, 2 * v, 0.2, 4, w, key_of(d)));
  colour = blend(colour, line, inside(std::abs(edge - 0.03) - 0.004, w));
  return blend(colour, cut, block(lines_of(d.text), d, u, v, w, 0.6));
}

Rgb numbers(const Decor& d, double u, double v, double w) {
  static const Rgb board = srgb(0x2c2018), white = srgb(0xefe8d2);
  return blend(board, white, block(lines_of(d.text), d, u, v, w, 0.72));
}

}  // namespace synth
