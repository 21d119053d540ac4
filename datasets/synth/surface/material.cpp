#include "surface/material.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "surface/noise.hpp"
#include "surface/pictures.hpp"

namespace synth {
namespace {

constexpr double kPaneRadiance = 0.28;  // stained glass towards the inside: bright, yet not burnt out

Spot spot_on(const Surface& surface, const Hit& hit, double footprint_m) {
  const Vec3 from = hit.point - surface.origin;
  Spot spot{from.dot(surface.u_axis), from.dot(surface.v_axis), std::max(footprint_m, 1e-5),
            mix(hit.surface) >> 20};
  if (surface.shape == Shape::free) {
    spot.u = hit.coordinates.x();
    spot.v = hit.coordinates.y();
  } else if (surface.shape != Shape::plane) {
    const double angle = std::atan2(from.y(), from.x());
    spot.u = angle * surface.radii.x();
    spot.v = from.z();
  }
  return spot;
}

double lamp_cover(const World& room, const Vec3& point, double footprint) {
  double share = 0;
  for (const AreaLight& light : room.lights) {
    if (!light.lamp) continue;
    const Vec3 from = point - light.centre;
    share += cover(from.x(), -light.half_v.x(), light.half_v.x(), footprint) *
             cover(from.y(), -light.half_u.y(), light.half_u.y(), footprint);
  }
  return std::min(1.0, share);
}

// Width and height of a planar surface in its texture frame.
Eigen::Array2d extent(const Surface& surface) {
  const Vec3 half = surface.centre - surface.origin;
  return {2 * half.dot(surface.u_axis), 2 * half.dot(surface.v_axis)};
}

// Fades into its own beginning over the last quarter turn, where the angle jumps.
Rgb stone_around(const Spot& s, double turn_m) {
  const double t = std::clamp((s.u / turn_m - 0.25) / 0.25, 0.0, 1.0);
  const Rgb here = stone(s);
  return t > 0 ? blend(here, stone({s.u - turn_m, s.v, s.footprint, s.key}), t) : here;
}

Rgb floor_albedo(const World& room, const Spot& s, const Vec3& point) {
  const Eigen::Array2d on_rug = point.head<2>().array() - room.rug_low, size = room.rug_high - room.rug_low;
  return rug({on_rug.x(), on_rug.y(), s.footprint, s.key}, size.x(), size.y(), planks(s));
}

Rgb base_albedo(const World& room, const Surface& surface, const Spot& s, const Vec3& point) {
  static const Rgb oak = srgb(0x7b4f2c), pine = srgb(0xc79f62), dark_pine = srgb(0xa67a40),
                   walnut = srgb(0x4f3020);
  const Eigen::Array2d size = extent(surface);
  const double turn_m = 2 * std::numbers::pi * surface.radii.x();
  const Spot along =
      size.y() > size.x() ? Spot{s.v, s.u, s.footprint, s.key} : s;  // grain along the longer side
  const Spot from_right{size.x() - s.u, s.v, s.footprint, s.key};
  switch (surface.material) {
    case Material::planks:
      return floor_albedo(room, s, point);
    case Material::ceiling_tiles:
      return ceiling_tiles(s);
    case Material::brick:
      return wall_trim(s, room.size.z(), brick(s));
    case Material::panelled_plaster:
      return wall_trim(s, room.size.z(), panelled_plaster(s));
    case Material::wallpaper:
      return wall_trim(s, room.size.z(), wallpaper(s));
    case Material::tiled_plaster:
      return wall_trim(s, room.size.z(), tiled_plaster(s));
    case Material::painted_wood:
      return painted_wood(s);
    case Material::corridor:
      return corridor(s);
    case Material::daylight:
      return daylight(s, size.x(), size.y());
    // The back sees the leaf mirrored: its knob is on the same edge.
    case Material::door:
      return door(surface.name.ends_with("-back") ? from_right : s, size.x(), size.y());
    case Material::oak:
      return wood(along, oak, 0.43);
    case Material::chest:
      return crate(s, size.x(), size.y(), oak, walnut);
    case Material::books:
      return surface.name.ends_with("-right") ? books(s, size.x(), size.y()) : wood(along, oak, 0.43);
    case Material::crate:
      return crate(s, size.x(), size.y(), pine, dark_pine);
    case Material::cardboard:
      return cardboard(s);
    case Material::stone:
      return stone_around(s, turn_m);
    case Material::glaze:
      return glaze(s, turn_m);
    default:
      return church_albedo(surface, s, size);
  }
}

double gloss_of(Material material) {
  switch (material) {
    case Material::brass:
      return 0.5;
    case Material::outer_glass:
      return 0.25;
    case Material::marble:
      return 0.08;
    case Material::chancel_tiles:
    case Material::red_paint:
      return 0.05;
    default:
      return 0;
  }
}

}  // namespace

Finish finish(const World& world, const Hit& hit, double footprint_m) {
  const Surface& surface = world.mesh.surfaces[hit.surface];
  const Spot spot = spot_on(surface, hit, footprint_m);
  Finish result{base_albedo(world, surface, spot, hit.point), Rgb::Zero(), gloss_of(surface.material)};
  for (const Decor& decor : world.decor_of_surface[hit.surface])
    result.albedo = paint(decor, spot, result.albedo);
  result.albedo = result.albedo.max(0.01).min(0.9);
  if (surface.material == Material::daylight) result.emission = 0.75 * result.albedo;
  if (surface.material == Material::stained_glass) {
    result.emission = kPaneRadiance * result.albedo;
    result.albedo = Rgb::Constant(0.03);
  }
  if (surface.material == Material::ceiling_tiles)
    result.emission = Rgb(1.0, 0.96, 0.88) * lamp_cover(world, hit.point, spot.footprint);
  return result;
}

}  // namespace synth
