#include "surface/masonry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/noise.hpp"

namespace synth {
namespace {

double noise(const Spot& s, double wavelength, int octaves, std::uint64_t salt) {
  return fractal_noise(s.u, s.v, wavelength, octaves, s.footprint, s.key ^ (salt * 0x61ull));
}

// A stone of a bond: its number, and how much of the footprint is joint.
struct Stone {
  std::int64_t column, row;
  double joint, u, v;  // u, v: within the stone, metres
};

Stone bond(const Spot& s, double length, double height, double joint, double wobble) {
  const double v = s.v + wobble * noise(s, 0.35, 2, 1), row = std::floor(v / height);
  const auto j = static_cast<std::int64_t>(row);
  const double stretch = 0.8 + 0.4 * hash01(j, 3, s.key);  // every course has its own length
  const double shift = length * hash01(j, 5, s.key);
  const double u = s.u + shift + wobble * noise(s, 0.3, 2, 2), l = length * stretch;
  const double column = std::floor(u / l);
  return {static_cast<std::int64_t>(column), j,
          1 - (1 - stripes(v + joint / 2, height, joint, s.footprint)) *
                  (1 - stripes(u + joint / 2, l, joint, s.footprint)),
          u - column * l, v - row * height};
}

// Rain has washed dark streaks down and lichen grows in spots.
double weather(const Spot& s) {
  const double streaks = fractal_noise(s.u * 3, s.v * 0.25, 0.6, 4, 3 * s.footprint, s.key + 71);
  return 1 + 0.16 * streaks + 0.10 * noise(s, 1.9, 3, 3);
}

}  // namespace

Rgb ashlar(const Spot& s) {
  static const Rgb warm = srgb(0xc9ac7c), cool = srgb(0xb3a58c), rust = srgb(0xb58a58),
                   mortar = srgb(0xd8cfbb);
  const Stone stone = bond(s, 0.62, 0.31, 0.012, 0.003);
  const double pick = hash01(stone.column, stone.row, s.key);
  Rgb colour = pick < 0.8 ? blend(warm, cool, pick / 0.8) : blend(warm, rust, (pick - 0.8) * 4);
  colour *= 0.88 + 0.24 * hash01(stone.row, stone.column, s.key + 9);
  colour *= 1 + 0.20 * noise(s, 0.07, 4, 4) +
            0.12 * fractal_noise(s.u * 0.4, s.v * 3, 0.12, 3, 3 * s.footprint, s.key + 5);
  return blend(colour * weather(s), mortar * (1 + 0.2 * noise(s, 0.02, 2, 6)), stone.joint * 0.85);
}

Rgb rubble(const Spot& s) {
  static const Rgb grey = srgb(0x9c9482), brown = srgb(0x8d7656), pale = srgb(0xc0b394),
                   mortar = srgb(0xa89f8c);
  const Stone stone = bond(s, 0.34, 0.19, 0.026, 0.03);
  const double pick = hash01(stone.column, stone.row, s.key + 2);
  Rgb colour = pick < 0.5 ? blend(grey, brown, 2 * pick) : blend(brown, pale, 2 * pick - 1);
  colour *= 0.8 + 0.4 * hash01(stone.row, stone.column, s.key + 4);
  colour *= 1 + 0.38 * noise(s, 0.09, 5, 7);
  return blend(colour * weather(s), mortar * (1 + 0.25 * noise(s, 0.03, 3, 8)), stone.joint);
}

Rgb dressed_stone(const Spot& s) {
  static const Rgb pale = srgb(0xd6c7a4);
  const double tooling = fractal_noise(s.u + s.v, (s.u - s.v) * 9, 0.06, 2, 9 * s.footprint, s.key + 3);
  const double joints = stripes(s.v, 0.52, 0.010, s.footprint);
  return pale * (1 + 0.14 * tooling + 0.12 * noise(s, 0.05, 4, 9)) * weather(s) * (1 - 0.45 * joints);
}

Rgb limewash(const Spot& s, double height_m) {
  static const Rgb white = srgb(0xe6dfcd), dado = srgb(0x9b5b45), line = srgb(0x5d3326),
                   ochre = srgb(0xc08a3c);
  const double w = s.footprint, stains = noise(s, 1.1, 5, 10), cracks = std::abs(noise(s, 0.9, 3, 11));
  Rgb colour = white * (1 + 0.06 * stains + 0.08 * noise(s, 0.04, 3, 12)) *
               (1 - 0.25 * inside((cracks - 0.004) * 0.9, w));
  if (height_m < 4) return colour;  // jambs and small walls stay plain
  // A painted dado with a row of lozenges, and false masonry in red lines above.
  const double lozenge = std::abs(s.u / 0.4 - std::round(s.u / 0.4)) * 0.4 + std::abs(s.v - 1.22) - 0.10;
  colour = blend(colour, dado * (1 + 0.15 * stains), cover(s.v, -1, 1.45, w));
  colour = blend(colour, ochre, inside(lozenge, w));
  colour = blend(colour, line, cover(s.v, 1.43, 1.46, w) + cover(s.v, 0.98, 1.0, w));
  if (s.v > 1.46) {
    const double row = std::floor(s.v / 0.42), shift = std::fmod(row, 2.0) > 0.5 ? 0.45 : 0.0;
    const double lines = std::max(stripes(s.v, 0.42, 0.010, w), stripes(s.u + shift, 0.9, 0.010, w));
    colour = blend(colour, dado, 0.6 * lines * std::clamp(0.75 + 0.8 * stains, 0.0, 1.0));
  }
  return colour;
}

Rgb vault_plaster(const Spot& s) {
  static const Rgb blue = srgb(0x3f5f93), gold = srgb(0xe0bd62);
  const double period = 0.7, row = std::floor(s.v / period);
  const double shift = std::fmod(std::abs(row), 2.0) > 0.5 ? period / 2 : 0.0;
  const double x = s.u + shift - (std::floor((s.u + shift) / period) + 0.5) * period,
               y = s.v - (row + 0.5) * period;
  const double radius = std::hypot(x, y), rays = std::cos(6 * std::atan2(y, x));
  const double star = radius - 0.055 * (0.75 + 0.45 * rays);
  return blend(blue * (1 + 0.16 * noise(s, 0.8, 4, 13) + 0.10 * noise(s, 0.04, 3, 14)), gold,
               inside(star, s.footprint));
}

Rgb flagstones(const Spot& s) {
  static const Rgb slate = srgb(0x8c8474), sand = srgb(0xb5a281), joint = srgb(0x5b5348);
  const Stone stone = bond(s, 0.72, 0.55, 0.010, 0.004);
  Rgb colour = blend(slate, sand, hash01(stone.column, stone.row, s.key + 6)) *
               (0.85 + 0.3 * hash01(stone.row, stone.column, s.key));
  colour *= 1 + 0.20 * noise(s, 0.14, 5, 15) + 0.10 * noise(s, 1.3, 2, 16);
  return blend(colour, joint, stone.joint);
}

Rgb chancel_tiles(const Spot& s) {
  static const Rgb red = srgb(0x96442e), buff = srgb(0xd2b277), black = srgb(0x2d2926);
  const double side = 0.16, w = s.footprint;
  const double i = std::floor(s.u / side), j = std::floor(s.v / side);
  const double x = s.u / side - i - 0.5, y = s.v / side - j - 0.5;
  const bool odd = std::fmod(std::abs(i + j), 2.0) > 0.5;
  Rgb colour = odd ? red : black;
  const double flower = (std::hypot(x, y) - 0.30 - 0.10 * std::cos(4 * std::atan2(y, x))) * side;
  colour = blend(colour, buff, inside(flower, w));
  colour = blend(colour, odd ? red : black, inside((std::hypot(x, y) - 0.13) * side, w));
  const double lines = std::max(stripes(s.u, side, 0.004, w), stripes(s.v, side, 0.004, w));
  return blend(colour * (1 + 0.08 * noise(s, 0.05, 3, 17)), srgb(0x7a7468), lines);
}

Rgb cobbles(const Spot& s) {
  static const Rgb grey = srgb(0x8b857a), brown = srgb(0x857257), moss = srgb(0x5d6a3d), gap = srgb(0x4a453b);
  const Stone stone = bond(s, 0.15, 0.12, 0.022, 0.012);
  Rgb colour = blend(grey, brown, hash01(stone.column, stone.row, s.key + 8)) *
               (0.75 + 0.5 * hash01(stone.row, stone.column, s.key));
  colour *= 1 + 0.2 * noise(s, 0.04, 3, 18);
  const double green = std::clamp(1.6 * noise(s, 3.5, 4, 19) - 0.1, 0.0, 0.7);
  return blend(blend(colour, gap, stone.joint), moss * (1 + 0.4 * noise(s, 0.05, 4, 20)), green) *
         (1 + 0.08 * noise(s, 2.2, 2, 21));
}

Rgb slates(const Spot& s) {
  static const Rgb blue = srgb(0x5d646e), brown = srgb(0x74675c);
  const Stone stone = bond(s, 0.30, 0.22, 0.008, 0);
  Rgb colour = blend(blue, brown, hash01(stone.column, stone.row, s.key + 1)) *
               (0.8 + 0.4 * hash01(stone.row, stone.column, s.key));
  return colour * (1 + 0.2 * noise(s, 0.08, 4, 22)) * (1 - 0.6 * stone.joint) *
         (0.8 + 0.2 * std::min(1.0, stone.v / 0.1));
}

Rgb marble(const Spot& s) {
  static const Rgb green = srgb(0x3c5a4c), pale = srgb(0xb9c4b2);
  const double warp = 0.3 * noise(s, 0.5, 4, 23);
  const double veins =
      std::pow(1 - std::abs(noise({s.u + warp, s.v + warp, s.footprint, s.key}, 0.35, 4, 24)), 8.0);
  return blend(green * (1 + 0.2 * noise(s, 0.1, 4, 25)), pale, 0.8 * veins);
}

Rgb stained_glass(const Spot& s) {
  static const Rgb colours[6] = {srgb(0x2f4fd0), srgb(0xd03028), srgb(0xf0c040),
                                 srgb(0x2f9a4c), srgb(0xf2e8c8), srgb(0x7a3fb0)};
  const double side = 0.17, w = s.footprint;
  // Quarries of a lattice, turned by 45 degrees, within a border.
  const double a = (s.u + s.v) / side * 0.70710678, b = (s.u - s.v) / side * 0.70710678;
  const auto i = static_cast<std::int64_t>(std::floor(a)), j = static_cast<std::int64_t>(std::floor(b));
  const double ring = std::fmod(std::abs(static_cast<double>(i + j)), 3.0);
  const std::size_t pick = ring < 0.5
                               ? static_cast<std::size_t>(6 * hash01(i, j, s.key))
                               : (ring < 1.5 ? 4u : static_cast<std::size_t>(2 * hash01(i, j, s.key + 3)));
  const Rgb glass =
      colours[pick] * (0.65 + 0.5 * hash01(j, i, s.key + 1)) * (1 + 0.25 * noise(s, 0.08, 3, 26));
  const double lead = std::max(stripes(a, 1, 0.07, w / side), stripes(b, 1, 0.07, w / side));
  const double bars = stripes(s.v, 0.62, 0.02, w);
  return blend(glass, Rgb::Constant(0.02), std::max(lead, bars));
}

Rgb outer_glass(const Spot& s) {
  static const Rgb dark = srgb(0x232a30), lead = srgb(0x55585a);
  const double side = 0.17, w = s.footprint;
  const double a = (s.u + s.v) / side * 0.70710678, b = (s.u - s.v) / side * 0.70710678;
  const double lines = std::max(stripes(a, 1, 0.07, w / side), stripes(b, 1, 0.07, w / side));
  const double tone = 0.6 + 0.8 * hash01(static_cast<std::int64_t>(std::floor(a)),
                                         static_cast<std::int64_t>(std::floor(b)), s.key);
  return blend(dark * tone, lead, std::max(lines, stripes(s.v, 0.62, 0.02, w)));
}

}  // namespace synth
