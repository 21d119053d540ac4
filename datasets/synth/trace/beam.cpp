#include "trace/beam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "surface/material.hpp"

namespace synth {
namespace {

constexpr double kMixedJumpM = 0.01;  // sub-rays farther than this from the centre's surface: mixed
constexpr int kSubRays = 8;
// Of the beams that meet a pane: measured on its dust, mirrored into the room, gone through; the rest is
// lost.
constexpr double kOnGlass = 0.30, kMirrored = 0.08, kThrough = 0.20;
constexpr double kFaintest = 0.012;  // signal at which six of ten beams are lost

double fading(double range_m) {
  return 1.0 / (1.0 + 0.01 * range_m * range_m);
}

}  // namespace

double Beam::reflectance(const Hit& hit, const Vec3& direction) const {
  const Rgb albedo = finish(world, hit, 2 * kBeamRadiusM).albedo;
  const double lambert = std::abs(hit.normal.dot(direction));
  return (0.6 * albedo.x() + 0.3 * albedo.y() + 0.1 * albedo.z()) * (0.25 + 0.75 * lambert);
}

// The sub-rays lie on a ring at 0.7 of the beam's radius. A bend between surfaces that meet leaves the
// return on the centre's surface; a jump in depth averages the parts by what each sends back.
std::optional<Return> Beam::on_solid(const Hit& centre, const Vec3& direction) const {
  const Surface& surface = world.mesh.surfaces[centre.surface];
  const double strength = reflectance(centre, direction);
  const double cosine = std::max(0.05, std::abs(centre.normal.dot(direction)));
  Return result{centre.distance_m,
                centre.distance_m,
                strength,
                static_cast<std::uint32_t>(surface.plane_id),
                surface.plane_id != 0 ? SampleKind::planar : SampleKind::curved,
                std::sqrt(1 - std::min(1.0, cosine * cosine)) / cosine};

  const Vec3 side =
      direction.cross(std::abs(direction.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized();
  const Vec3 up = side.cross(direction);
  const double radius = 0.7 * (kBeamRadiusM / std::max(0.5, centre.distance_m) + kBeamSpreadRad);
  double sum = 0, weights = 0;
  bool jumps = false;
  const auto add = [&](const Hit& hit, const Vec3& ray) {
    const double weight = reflectance(hit, ray);
    sum += weight * hit.distance_m;
    weights += weight;
  };
  std::array<std::optional<Hit>, kSubRays> hits;
  std::array<Vec3, kSubRays> rays;
  for (std::size_t k = 0; k < kSubRays; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kSubRays;
    rays[k] = (direction + radius * (std::cos(angle) * side + std::sin(angle) * up)).normalized();
    hits[k] = tracer.nearest_solid(mirror, rays[k]);
    if (!hits[k]) continue;
    const double expected = (centre.normal.dot(centre.point - mirror)) / centre.normal.dot(rays[k]);
    jumps |= !(std::abs(hits[k]->distance_m - expected) < kMixedJumpM);
  }
  if (!jumps) return result;
  add(centre, direction);
  for (std::size_t k = 0; k < kSubRays; ++k)
    if (hits[k]) add(*hits[k], rays[k]);
  result.range_m = sum / weights;
  result.reflectance = weights / (kSubRays + 1);
  result.plane_id = 0;
  result.kind = SampleKind::mixed;
  return result;
}

// A glossy surface sends the beam on, unless it stands square to it; a dark one swallows it.
bool Beam::lost(const Hit& hit, const Vec3& direction, double strength, Random& chance) const {
  const double draw = chance.uniform();
  const double gloss = finish(world, hit, 2 * kBeamRadiusM).gloss;
  const double square_on = std::pow(std::abs(hit.normal.dot(direction)), 16.0);
  const double mirrored = std::min(0.95, 1.6 * gloss) * (1 - square_on);
  const double swallowed = std::exp(-strength * fading(hit.distance_m) / kFaintest);
  return draw < 1 - (1 - mirrored) * (1 - swallowed);
}

std::optional<Return> Beam::at_glass(const Hit& pane, const Vec3& direction, Random& chance) const {
  const double draw = chance.uniform();
  if (draw < kOnGlass)
    return Return{pane.distance_m, pane.distance_m, 0.3 * reflectance(pane, direction),
                  static_cast<std::uint32_t>(world.mesh.surfaces[pane.surface].plane_id), SampleKind::planar};
  if (draw < kOnGlass + kMirrored) {
    const Vec3 onwards = direction - 2 * pane.normal.dot(direction) * pane.normal;
    const auto met = tracer.nearest_solid(pane.point + 1e-3 * pane.normal, onwards);
    if (!met) return std::nullopt;
    return Return{pane.distance_m + met->distance_m, pane.distance_m, 0.15 * reflectance(*met, onwards), 0,
                  SampleKind::ghost};
  }
  if (draw >= kOnGlass + kMirrored + kThrough) return std::nullopt;
  const auto beyond = tracer.nearest_solid(mirror, direction);
  if (!beyond) return std::nullopt;
  auto result = on_solid(*beyond, direction);
  result->reflectance *= 0.4;
  return result;
}

std::optional<Return> Beam::measure(const Vec3& direction, Random& chance) const {
  const std::optional<Hit> centre = tracer.nearest(mirror, direction);
  if (!centre) return std::nullopt;
  if (!optics) return on_solid(*centre, direction);
  if (is_glass(world.mesh.surfaces[centre->surface].material)) return at_glass(*centre, direction, chance);
  if (lost(*centre, direction, reflectance(*centre, direction), chance)) return std::nullopt;
  return on_solid(*centre, direction);
}

}  // namespace synth
