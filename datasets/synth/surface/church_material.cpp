#include "surface/lettering.hpp"
#include "surface/masonry.hpp"
#include "surface/material.hpp"
#include "surface/noise.hpp"

namespace synth {
namespace {

// Cloth, skin, leaves: a colour that varies from thing to thing, mottled.
Rgb mottled(const Spot& s, const Rgb& colour, const Rgb& other, double wavelength, double depth) {
  const double pick = hash01(7, 11, s.key);
  return blend(colour, other, pick) *
         (1 + depth * fractal_noise(s.u, s.v, wavelength, 4, s.footprint, s.key + 13));
}

}  // namespace

Rgb church_albedo(const Surface& surface, const Spot& s, const Eigen::Array2d& extent) {
  static const Rgb pew = srgb(0x6e4526), door = srgb(0x5a3a22), ceiling = srgb(0x8a6238);
  const bool upright = surface.shape == Shape::plane && extent.y() > extent.x();
  const Spot along = upright ? Spot{s.v, s.u, s.footprint, s.key} : s;
  switch (surface.material) {
    case Material::ashlar:
      return ashlar(s);
    case Material::rubble:
      return rubble(s);
    case Material::dressed_stone:
      return dressed_stone(s);
    case Material::marble:
      return marble(s);
    case Material::limewash:
      return limewash(s, surface.shape == Shape::plane ? std::min(extent.x(), extent.y()) : 0);
    case Material::vault_plaster:
      return vault_plaster(s);
    case Material::timber:
      return wood(along, ceiling, 0.24);
    case Material::pew_wood:
      return wood(along, pew, 0.3);
    case Material::oak_door: {
      const double studs =
          inside(std::hypot(s.u - 0.2 * std::round(s.u / 0.2), s.v - 0.35 * std::round(s.v / 0.35)) - 0.016,
                 s.footprint);
      const double straps =
          cover(std::abs(s.v - extent.y() / 2) - 0.32 * extent.y(), -0.035, 0.035, s.footprint);
      return blend(wood({s.v, s.u, s.footprint, s.key}, door, 0.17), srgb(0x202022),
                   std::max(straps, 0.9 * studs));
    }
    case Material::flagstones:
      return flagstones(s);
    case Material::chancel_tiles:
      return chancel_tiles(s);
    case Material::cobbles:
      return cobbles(s);
    case Material::slate:
      return slates(s);
    case Material::lawn:
      return mottled(s, srgb(0x55692f), srgb(0x6a7a3a), 0.2, 0.5);
    case Material::carpet:
      return mottled(s, srgb(0x8c2430), srgb(0x8c2430), 0.02, 0.2);
    case Material::linen: {
      const double weave = stripes(s.u, 0.012, 0.006, s.footprint) + stripes(s.v, 0.012, 0.006, s.footprint);
      const double hem = cover(s.v, 0.05, 0.08, s.footprint) + cover(s.v, 0.11, 0.12, s.footprint);
      return blend(srgb(0xe9e2d0) * (0.94 + 0.06 * weave), srgb(0xa2823a), 0.9 * std::min(1.0, hem));
    }
    case Material::iron:
      return mottled(s, srgb(0x3a3a3d), srgb(0x4a4744), 0.05, 0.3);
    case Material::brass:
      return mottled(s, srgb(0xb88a3a), srgb(0xb88a3a), 0.05, 0.1);
    case Material::rubber:
      return mottled(s, srgb(0x1d1d20), srgb(0x1d1d20), 0.03, 0.2);
    case Material::red_paint:
      return srgb(0xb02a20);
    case Material::coat:
      return mottled(s, hash01(3, 5, s.key) < 0.5 ? srgb(0x2f4a70) : srgb(0x7a2c38),
                     hash01(9, 5, s.key) < 0.5 ? srgb(0x3c5a3c) : srgb(0x8a6a42), 0.03, 0.35) *
             (0.9 + 0.2 * stripes(s.u, 0.06, 0.03, s.footprint));
    case Material::skin:
      return mottled(s, srgb(0xc99a7c), srgb(0x9a6a4c), 0.05, 0.1);
    case Material::foliage:
      return mottled(s, srgb(0x35512a), srgb(0x44602f), 0.14, 0.8);
    case Material::notice_board:
      return blend(srgb(0x234034), srgb(0x1a2c24), hash01(1, 2, s.key));
    case Material::stained_glass:
      return stained_glass(s);
    case Material::outer_glass:
      return outer_glass(s);
    default:
      return Rgb::Constant(0.5);
  }
}

}  // namespace synth
