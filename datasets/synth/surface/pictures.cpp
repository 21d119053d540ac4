#include "surface/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/lettering.hpp"
#include "surface/noise.hpp"
#include "surface/notices.hpp"

namespace synth {
namespace {

// An optician's chart: the word, then hashed letters in lines that halve, so sharpness can be read off.
Rgb chart(const Decor& d, double u, double v, double w) {
  static const Rgb paper = srgb(0xe9e4d4), ink = srgb(0x1c1a1e), red = srgb(0xa02a24);
  double top = d.height_m * 0.94, height = d.height_m * 0.16, mark = 0;
  for (int line = 0; line < 7; ++line) {
    std::string text = line == 0 ? d.text : "";
    for (int k = 0; line > 0 && k < 5 + 2 * line; ++k)
      text += static_cast<char>(
          'A' + static_cast<int>(26 * hash01(line, k, static_cast<std::uint64_t>(d.text.front()) * 977 + 5)));
    const double margin = d.width_m * 0.08;
    if (v < top + w && v > top - height - w)
      mark =
          std::max(mark, lettering(text, u - margin, v - (top - height), d.width_m - 2 * margin, height, w));
    top -= height + d.height_m * 0.03;
    height *= 0.78;
  }
  const double rule =
      cover(v, d.height_m * 0.755, d.height_m * 0.762, w) * cover(u, 0.08 * d.width_m, 0.92 * d.width_m, w);
  return blend(blend(paper, ink, mark), red, rule);
}

// Siemens star: 24 spokes; where they blur into grey tells the resolution in every direction.
Rgb star(const Decor& d, double u, double v, double w) {
  static const Rgb paper = srgb(0xe4e1d6), ink = srgb(0x18181c), red = srgb(0xb4342c);
  const double x = u - d.width_m / 2, y = v - d.height_m / 2, radius = std::hypot(x, y);
  const double turn = (std::atan2(y, x) / (2 * std::numbers::pi) + 0.5) * 24;
  const double spokes =
      stripes(turn, 1, 0.5, std::min(8.0, w * 24 / (2 * std::numbers::pi * std::max(radius, 1e-4))));
  const double disc = inside(radius - 0.44 * std::min(d.width_m, d.height_m), w);
  return blend(blend(paper, ink, spokes * disc), red, inside(radius - 0.012, w));
}

Rgb landscape(const Decor& d, double u, double v, double w) {
  static const Rgb zenith = srgb(0x4c7fb5), haze = srgb(0xf0cf9a), sun = srgb(0xffe9a8),
                   lake = srgb(0x4f7d8c);
  const double x = u / d.width_m, y = v / d.height_m;
  const double place = 7.3 * d.left_m;  // no two alike
  Rgb colour = blend(haze, zenith, std::clamp((y - 0.35) * 1.6, 0.0, 1.0));
  const double cloud = fractal_noise(u + place, v * 3, 0.5, 5, w, 77);
  colour = blend(colour, srgb(0xfbf3e4), std::clamp(cloud * 1.6 - 0.1, 0.0, 0.8));
  colour = blend(
      colour, sun,
      inside(std::hypot(u - (0.3 + 0.4 * hash01(static_cast<std::int64_t>(100 * d.left_m), 0, 3)) * d.width_m,
                        v - 0.72 * d.height_m) -
                 0.07,
             w));
  for (int ridge = 0; ridge < 4; ++ridge) {
    const double base = 0.56 - 0.09 * ridge;
    const double crest =
        (base + 0.13 * fractal_noise(u + place + 3.1 * ridge, 0.5, 0.55, 5, w, 91 + ridge)) * d.height_m;
    const Rgb tone = blend(srgb(0x7d8fa6), srgb(0x2e4a2b), ridge / 3.0);
    colour =
        blend(colour, tone * (1 + 0.3 * fractal_noise(u, v, 0.08, 4, w, 95 + ridge)), inside(v - crest, w));
  }
  const double shore = (0.2 + 0.05 * std::sin(x * 5)) * d.height_m;
  return blend(colour, lake * (1 + 0.35 * fractal_noise(u, v * 9, 0.3, 4, w, 99)), inside(v - shore, w));
}

// Rectangles of flat colour between black bars.
Rgb blocks(const Decor& d, double u, double v, double w) {
  static const Rgb palette[5] = {srgb(0xe6e0d0), srgb(0xb8302a), srgb(0x22489a), srgb(0xe0b53a),
                                 srgb(0xdad6cc)};
  static const Rgb bar = srgb(0x15151a);
  const double us[5] = {0, 0.22, 0.5, 0.81, 1}, vs[5] = {0, 0.3, 0.44, 0.78, 1};
  Rgb colour = Rgb::Zero();
  double line = 0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i)
      colour += palette[static_cast<int>(5 * hash01(i, j, 1931))] *
                cover(u, us[i] * d.width_m, us[i + 1] * d.width_m, w) *
                cover(v, vs[j] * d.height_m, vs[j + 1] * d.height_m, w);
    line = std::max(line, cover(u, us[j] * d.width_m - 0.012, us[j] * d.width_m + 0.012, w));
    line = std::max(line, cover(v, vs[j] * d.height_m - 0.012, vs[j] * d.height_m + 0.012, w));
  }
  return blend(colour, bar, line) * (1 + 0.06 * fractal_noise(u, v, 0.03, 3, w, 61));
}

Rgb sign(const Decor& d, double u, double v, double w) {
  static const Rgb board = srgb(0x1f3d36), letters = srgb(0xe8d9a6);
  const double margin = d.height_m * 0.22;
  return blend(board, letters,
               lettering(d.text, u - margin, v - margin, d.width_m - 2 * margin, d.height_m - 2 * margin, w));
}

Rgb inner(const Decor& d, double u, double v, double w) {
  switch (d.picture) {
    case Picture::chart:
      return chart(d, u, v, w);
    case Picture::star:
      return star(d, u, v, w);
    case Picture::landscape:
      return landscape(d, u, v, w);
    case Picture::blocks:
      return blocks(d, u, v, w);
    case Picture::sign:
      return sign(d, u, v, w);
    case Picture::notice:
      return notice(d, u, v, w);
    case Picture::plaque:
      return plaque(d, u, v, w);
    case Picture::numbers:
      return numbers(d, u, v, w);
  }
  return Rgb::Zero();
}

}  // namespace

Rgb paint(const Decor& d, const Spot& s, const Rgb& wall) {
  const double u = s.u - d.left_m, v = s.v - d.bottom_m, w = s.footprint;
  // Distance to the picture's rectangle, negative inside; the frame goes around it.
  const double edge =
      std::max(std::abs(u - d.width_m / 2) - d.width_m / 2, std::abs(v - d.height_m / 2) - d.height_m / 2);
  const double frame = 0.12 * std::min(0.5, d.height_m);
  if (edge > frame + w) return wall;
  static const Rgb gilt = srgb(0x9a7434), walnut = srgb(0x4a2f1f);
  const bool rich = d.picture == Picture::landscape;
  Rgb moulding = (rich ? gilt : walnut) * (1 + 0.25 * fractal_noise(s.u, s.v, 0.03, 3, w, 31));
  moulding *= 1 - 0.5 * inside(std::abs(edge - 0.5 * frame) - 0.1 * frame, w);
  const Rgb picture = edge < w ? inner(d, u, v, w) : moulding;
  return blend(blend(wall, moulding, inside(edge - frame, w)), picture, inside(edge, w));
}

}  // namespace synth
