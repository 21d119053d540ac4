#include "surface/patterns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/noise.hpp"

namespace synth {
namespace {

double noise(const Spot& s, double stretch_u, double stretch_v, double wavelength, int octaves,
             std::uint64_t salt) {
  return fractal_noise(s.u * stretch_u, s.v * stretch_v, wavelength, octaves,
                       s.footprint * std::max(stretch_u, stretch_v), s.key ^ (salt * 0x51ull));
}

// Plaster: trowel marks of a hand's width over fine grain.
double plaster_grain(const Spot& s) {
  return 0.05 * noise(s, 1, 1, 0.45, 4, 1) + 0.07 * noise(s, 1, 1, 0.03, 3, 2);
}

// Rectangles in a row with lines lit from the upper left, as painted trompe-l'oeil panels.
Rgb panels(const Spot& s, double low, double high, double period, const Rgb& colour) {
  const double u = s.u - std::floor(s.u / period) * period;
  const double edge = 0.07, line = 0.014, right = period - edge, w = s.footprint;
  const double across = cover(u, edge, right, w), along = cover(s.v, low + edge, high - edge, w);
  const double lit =
      cover(u, edge, edge + line, w) * along + cover(s.v, high - edge - line, high - edge, w) * across;
  const double dark =
      cover(u, right - line, right, w) * along + cover(s.v, low + edge, low + edge + line, w) * across;
  return colour * (1 + 0.25 * lit - 0.4 * dark) * (1 - 0.06 * across * along) *
         (1 + 0.05 * noise(s, 1, 12, 0.2, 3, 3));
}

}  // namespace

Rgb srgb(unsigned hex) {
  const auto linear = [](unsigned byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return {linear(hex >> 16 & 255), linear(hex >> 8 & 255), linear(hex & 255)};
}

Rgb wood(const Spot& s, const Rgb& colour, double plank_width_m) {
  const double row = std::floor(s.v / plank_width_m);
  const double shift = 2.1 * hash01(static_cast<std::int64_t>(row), 7, s.key);
  const double board = std::floor((s.u + shift) / 2.1);
  const auto i = static_cast<std::int64_t>(board), j = static_cast<std::int64_t>(row);
  const double tone = 0.78 + 0.44 * hash01(i, j, s.key + 1);
  const Spot grain{s.u + 17 * hash01(i, j, s.key + 2), s.v + 5 * hash01(j, i, s.key), s.footprint, s.key};
  const double rings = noise(grain, 1, 14, 0.5, 5, 4), fibre = noise(grain, 4, 60, 0.15, 3, 5);
  const double gap = std::max(stripes(s.v, plank_width_m, 0.004, s.footprint),
                              stripes(s.u + shift, 2.1, 0.004, s.footprint));
  return colour * tone * (1 + 0.38 * rings + 0.16 * fibre) * (1 - 0.75 * gap);
}

Rgb planks(const Spot& s) {
  static const Rgb oak = srgb(0xa9794a);
  return wood(s, oak, 0.16);
}

Rgb rug(const Spot& s, double width_m, double height_m, const Rgb& floor) {
  static const Rgb red = srgb(0x8e2f2b), navy = srgb(0x23345c), cream = srgb(0xd9c79c), gold = srgb(0xb98a3a);
  const double edge =
      std::max(std::abs(s.u - width_m / 2) - width_m / 2, std::abs(s.v - height_m / 2) - height_m / 2);
  if (edge > s.footprint) return floor;
  const double w = s.footprint, period = 0.4;
  const double u = s.u - width_m / 2, v = s.v - height_m / 2;
  const double du = std::abs(u / period - std::round(u / period)),
               dv = std::abs(v / period - std::round(v / period));
  const double diamond = (du + dv - 0.42) * period * 0.7, core = (std::hypot(du, dv) - 0.16) * period;
  Rgb colour = blend(red, navy, inside(diamond, w));
  colour = blend(colour, cream, inside(std::abs(diamond) - 0.008, w));
  colour = blend(colour, gold, inside(core, w));
  colour = blend(navy, colour, inside(edge + 0.22, w));
  colour = blend(colour, cream,
                 inside(std::abs(edge + 0.22) - 0.012, w) + inside(std::abs(edge + 0.06) - 0.018, w));
  const double beads = stripes(s.u + s.v, 0.09, 0.045, w) * inside(std::abs(edge + 0.14) - 0.03, w);
  colour = blend(colour, gold, std::min(1.0, beads));
  colour *= 1 + 0.22 * noise(s, 1, 1, 0.02, 3, 6) + 0.08 * (stripes(s.u, 0.012, 0.006, w) - 0.5);
  return blend(floor, colour, inside(edge, w));
}

Rgb ceiling_tiles(const Spot& s) {
  static const Rgb white = srgb(0xe4e0d4);
  const double groove =
      std::max(stripes(s.u, 0.6, 0.012, s.footprint), stripes(s.v, 0.6, 0.012, s.footprint));
  const double tone = 0.93 + 0.1 * hash01(static_cast<std::int64_t>(std::floor(s.u / 0.6)),
                                          static_cast<std::int64_t>(std::floor(s.v / 0.6)), s.key);
  const double pits = std::max(0.0, noise(s, 1, 1, 0.024, 2, 7) - 0.25);
  return white * tone * (1 - 0.55 * groove) * (1 - 0.7 * pits) * (1 + 0.03 * noise(s, 1, 1, 0.3, 2, 8));
}

Rgb brick(const Spot& s) {
  static const Rgb clay = srgb(0xa2543a), dark = srgb(0x6a3327), pale = srgb(0xc48a63),
                   mortar = srgb(0xb9b0a0);
  const double course = 0.075, length = 0.225, joint = 0.011;
  const double row = std::floor(s.v / course);
  const double u =
      s.u + (std::fmod(std::abs(row), 2.0) > 0.5 ? length / 2 : 0.0) + 0.006 * noise(s, 1, 1, 0.08, 2, 9);
  const double v = s.v + 0.004 * noise(s, 1, 1, 0.06, 2, 10);
  const auto i = static_cast<std::int64_t>(std::floor(u / length)), j = static_cast<std::int64_t>(row);
  const double pick = hash01(i, j, s.key);
  Rgb colour = pick < 0.25 ? blend(dark, clay, pick * 4) : blend(clay, pale, (pick - 0.25) * 0.8);
  colour *= 1 + 0.35 * noise(s, 1, 1, 0.09, 5, 11);
  const double joints =
      1 - (1 - stripes(v, course, joint, s.footprint)) * (1 - stripes(u, length, joint, s.footprint));
  return blend(colour, mortar * (1 + 0.3 * noise(s, 1, 1, 0.02, 2, 12)), joints);
}

Rgb panelled_plaster(const Spot& s) {
  static const Rgb teal = srgb(0x7fa3a0), cream = srgb(0xd8d2bf);
  if (s.v < 0.95) return panels(s, 0.1, 0.95, 0.8, cream);
  // A stencilled chain along the top of the plaster.
  const double du = s.u / 0.3 - std::round(s.u / 0.3), dv = (s.v - 3.35) / 0.3;
  const double motif = inside(std::abs(std::hypot(du, dv) - 0.32) * 0.3 - 0.02, s.footprint) +
                       inside((std::abs(du) + std::abs(dv) - 0.16) * 0.3, s.footprint);
  return blend(teal, srgb(0x2f5c66), 0.85 * std::min(1.0, motif)) * (1 + 1.6 * plaster_grain(s));
}

Rgb wallpaper(const Spot& s) {
  static const Rgb ground = srgb(0xb7b788), leaf = srgb(0x56703f), bloom = srgb(0xa8483f),
                   cream = srgb(0xe6dfc2);
  static const Rgb wainscot = srgb(0x5d4433);
  if (s.v < 0.95) return panels(s, 0.1, 0.95, 0.8, wainscot);
  const double w = s.footprint, period = 0.36;
  const double row = std::floor(s.v / period), shift = std::fmod(std::abs(row), 2.0) > 0.5 ? period / 2 : 0.0;
  const double column = std::floor((s.u + shift) / period);
  const double x = s.u + shift - (column + 0.5) * period, y = s.v - (row + 0.5) * period;
  const double radius = std::hypot(x, y), angle = std::atan2(y, x);
  const double petals = radius - 0.075 * (0.72 + 0.28 * std::cos(5 * angle + column * 1.7 + row));
  const double leaves = radius - 0.15 * std::pow(std::abs(std::cos(2 * angle)), 3.0);
  const double vine = std::abs(s.u - 0.05 * std::sin(s.v * 2 * std::numbers::pi / period) -
                               std::round(s.u / (period / 2)) * period / 2);
  Rgb colour = ground * (1 + 0.12 * (stripes(s.u, 0.02, 0.01, w) - 0.5));
  colour = blend(colour, leaf, 0.55 * inside(vine - 0.006, w));
  colour = blend(colour, leaf, inside(leaves, w));
  colour = blend(colour, bloom, inside(petals, w));
  colour = blend(colour, cream, inside(radius - 0.02, w));
  return colour * (1 + 0.1 * noise(s, 1, 1, 0.02, 3, 13) + 0.05 * noise(s, 1, 1, 0.9, 2, 14));
}

Rgb tiled_plaster(const Spot& s) {
  static const Rgb ochre = srgb(0xcf9f5c), blue = srgb(0x3f6d8f), white = srgb(0xdcd9cc),
                   grout = srgb(0x8d8a80);
  if (s.v >= 1.2) {
    const double stain = noise(s, 1, 0.4, 0.8, 4, 15);
    return ochre * (1 + 2.0 * plaster_grain(s) + 0.12 * stain);
  }
  const double side = 0.15, w = s.footprint;
  const auto i = static_cast<std::int64_t>(std::floor(s.u / side)),
             j = static_cast<std::int64_t>(std::floor(s.v / side));
  const double x = s.u / side - static_cast<double>(i) - 0.5, y = s.v / side - static_cast<double>(j) - 0.5;
  Rgb colour = ((i + j) & 1) ? blue : white;
  colour *= 0.88 + 0.24 * hash01(i, j, s.key);
  const double star = (std::abs(x) + std::abs(y) + 0.25 * std::cos(4 * std::atan2(y, x)) - 0.32) * side;
  colour = blend(colour, ((i + j) & 1) ? white : blue, 0.9 * inside(star, w));
  const double lines = std::max(stripes(s.u, side, 0.006, w), stripes(s.v, side, 0.006, w));
  return blend(colour * (1 + 0.06 * noise(s, 1, 1, 0.05, 3, 16)), grout, lines);
}

Rgb wall_trim(const Spot& s, double wall_height_m, const Rgb& wall) {
  static const Rgb skirting = srgb(0xcfc8b6), frieze = srgb(0xe2dccb);
  const double w = s.footprint, v = s.v;
  Rgb colour = blend(wall, skirting * (1 + 0.06 * noise(s, 1, 10, 0.3, 3, 17)), cover(v, -1, 0.13, w));
  colour *= 1 - 0.45 * cover(v, 0.13, 0.142, w);
  colour =
      blend(colour, frieze * (1 + 0.04 * noise(s, 1, 10, 0.3, 3, 18)), cover(v, wall_height_m - 0.16, 99, w));
  const double dentils =
      stripes(s.u, 0.12, 0.06, w) * cover(v, wall_height_m - 0.12, wall_height_m - 0.06, w);
  colour *= 1 - 0.3 * dentils - 0.45 * cover(v, wall_height_m - 0.172, wall_height_m - 0.16, w);
  return colour;
}

Rgb painted_wood(const Spot& s) {
  static const Rgb cream = srgb(0xdfd7c2);
  return cream * (1 + 0.1 * noise(s, 3, 3, 0.3, 4, 19)) * (1 - 0.35 * stripes(s.v, 0.3, 0.006, s.footprint));
}

Rgb corridor(const Spot& s) {
  static const Rgb rose = srgb(0x9c5f58), grey = srgb(0x4c5560), stripe = srgb(0xd8c690);
  const Rgb upper = blend(rose, stripe, 0.75 * stripes(s.u, 0.12, 0.02, s.footprint));
  return blend(upper, grey, cover(s.v, -1, 0.95, s.footprint)) * (1 + 1.8 * plaster_grain(s));
}

Rgb daylight(const Spot& s, double width_m, double height_m) {
  static const Rgb sky = srgb(0x8fb9e0), low_sky = srgb(0xe9eef0), tree = srgb(0x4f6b3c),
                   field = srgb(0x8fa05a);
  static const Rgb bars = srgb(0xe8e4d8);
  const double w = s.footprint;
  Rgb colour = blend(low_sky, sky, std::clamp(s.v / height_m, 0.0, 1.0));
  colour = blend(colour, srgb(0xffffff), std::clamp(1.5 * noise(s, 1, 2, 0.7, 5, 26), 0.0, 0.9));
  const double crowns = 0.62 + 0.22 * fractal_noise(s.u, 0.3, 0.5, 5, w, s.key);
  colour = blend(colour, tree * (1 + 0.5 * noise(s, 1, 1, 0.12, 4, 27)), inside(s.v - crowns, w));
  colour = blend(colour, field * (1 + 0.3 * noise(s, 1, 5, 0.2, 4, 28)), inside(s.v - 0.36, w));
  // Three by three panes.
  const double pane_u = width_m / 3, pane_v = height_m / 3, bar = 0.05;
  const double bars_share =
      std::max(stripes(s.u + bar / 2, pane_u, bar, w), stripes(s.v + bar / 2, pane_v, bar, w));
  return blend(colour, bars, std::min(1.0, bars_share));
}

Rgb door(const Spot& s, double width_m, double height_m) {
  static const Rgb green = srgb(0x2f5f54), brass = srgb(0xcaa24a);
  const double period = width_m / 2, third = height_m / 3;
  const double row = std::min(2.0, std::max(0.0, std::floor(s.v / third)));
  Rgb colour = panels({s.u, s.v - row * third, s.footprint, s.key}, 0, third, period, green);
  const double knob = std::hypot(s.u - 0.07, s.v - 1.02);
  return blend(colour, brass, width_m > 0.3 ? inside(knob - 0.032, s.footprint) : 0.0);
}

Rgb crate(const Spot& s, double width_m, double height_m, const Rgb& slats, const Rgb& frame) {
  const double edge = std::min({s.u, s.v, width_m - s.u, height_m - s.v});
  const double beam = inside(edge - 0.07, s.footprint),
               seam = inside(std::abs(edge - 0.07) - 0.003, s.footprint);
  const Rgb upright = wood({s.v, s.u, s.footprint, s.key + 3}, frame, 0.5);
  return blend(wood(s, slats, 0.1), upright, beam) * (1 - 0.6 * seam);
}

Rgb books(const Spot& s, double width_m, double height_m) {
  static const Rgb spines[6] = {srgb(0x7c2b2b), srgb(0x2e4a68), srgb(0x37573b),
                                srgb(0xb0905a), srgb(0x4b3550), srgb(0xc9bfa5)};
  static const Rgb oak = srgb(0x7b4f2c), gold = srgb(0xcdb266);
  const double w = s.footprint, board = 0.03, shelf = (height_m - board) / 3, thick = 0.042;
  const double row = std::floor((s.v - board) / shelf), v = s.v - board - row * shelf;
  const double column = std::floor(s.u / thick), u = s.u - column * thick;
  const auto i = static_cast<std::int64_t>(column), j = static_cast<std::int64_t>(row);
  const double height = shelf * (0.62 + 0.25 * hash01(i, j, 41));
  Rgb spine = spines[static_cast<int>(6 * hash01(i, j, 43))] * (0.8 + 0.4 * hash01(i, j, 47));
  spine *= 1 - 0.6 * (1 - cover(u, 0.003, thick - 0.003, w));
  const double bands = cover(v, 0.22 * height, 0.26 * height, w) + cover(v, 0.72 * height, 0.82 * height, w);
  spine = blend(spine, gold, 0.8 * bands);
  const Rgb filled = blend(oak * 0.25, spine, cover(v, 0, height, w));
  const double rim = std::min({s.u, width_m - s.u, v + board, shelf - v, height_m - s.v});
  return blend(filled, wood(s, oak, 0.4), inside(rim - board, w));
}

Rgb cardboard(const Spot& s) {
  static const Rgb brown = srgb(0xb78d5d), tape = srgb(0xd9c89a);
  return blend(brown, tape, 0.7 * cover(s.v, 0.13, 0.18, s.footprint)) *
         (1 + 0.1 * noise(s, 1, 1, 0.05, 4, 20));
}

Rgb stone(const Spot& s) {
  static const Rgb pale = srgb(0xcabfa8), vein = srgb(0x7d6f60);
  const double warp = 0.35 * noise(s, 1, 1, 0.5, 4, 21);
  const double veins =
      std::pow(1 - std::abs(noise({s.u + warp, s.v + warp, s.footprint, s.key}, 1, 0.6, 0.4, 4, 22)), 9.0);
  const double drum = stripes(s.v, 0.8, 0.012, s.footprint);
  return blend(pale, vein, 0.75 * veins) * (1 + 0.12 * noise(s, 1, 1, 0.03, 3, 23)) * (1 - 0.55 * drum);
}

Rgb glaze(const Spot& s, double turn_m) {
  static const Rgb white = srgb(0xd5d8d6), cobalt = srgb(0x20408f);
  const double angle = s.u / turn_m, spacing = turn_m / 20;  // whole numbers of waves and dots: no seam
  const double wave = 0.035 * std::sin(angle * 12 * std::numbers::pi);
  const double bands = stripes(s.v + wave, 0.21, 0.07, s.footprint);
  const double du = (angle * 20 - std::round(angle * 20)) * spacing, dv = std::fmod(s.v + 9, 0.21) - 0.15;
  const double dots = inside(std::hypot(du, dv) - 0.024, s.footprint);
  return blend(white, cobalt, std::min(1.0, bands + dots));
}

}  // namespace synth
