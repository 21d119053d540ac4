// Lambertian surfaces lit by rectangular lights and a constant ambient term that stands for the bounces, or
// by the sun and gathered indirect light: look the same from everywhere, as projecting photographs onto
// geometry assumes. Glossy ones add one mirrored ray.
#include "trace/render.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "surface/material.hpp"
#include "trace/irradiance.hpp"
#include "trace/sky.hpp"

namespace synth {
namespace {

constexpr double kSunRadiusRad = 0.0047;

struct Shader {
  const World& world;
  const Tracer& tracer;
  const IndirectLight* indirect;
  int light_samples;

  static Rgb ambient(const Vec3& normal) {
    static const Rgb from_below(0.50, 0.44, 0.37), from_above(0.17, 0.175, 0.19);
    return blend(from_below, from_above, 0.5 + 0.5 * normal.z());
  }

  // Exact unoccluded irradiance times the sampled share of the light that is seen: noise in penumbrae only.
  Rgb direct(const Hit& hit, Random& random, int stratum, int strata) const {
    Rgb sum = Rgb::Zero();
    const int total = strata * light_samples;
    for (const AreaLight& light : world.lights) {
      const Vec3 &u = light.half_u, &v = light.half_v, &c = light.centre;
      const double turn_u = random.uniform(), turn_v = random.uniform();
      const double open = form_factor(hit.point, hit.normal, {c - u - v, c + u - v, c + u + v, c - u + v});
      if (open <= 0) continue;
      const Vec3 facing = u.cross(v);
      double seen = 0, weights = 0;
      for (int k = 0; k < light_samples; ++k) {
        const int index = stratum * light_samples + k;
        // One stratum in u per sample of the pixel; v by the golden ratio.
        const double a = (index + turn_u) / total, b = std::fmod(index * 0.6180339887498949 + turn_v, 1.0);
        const Vec3 target = c + u * (2 * a - 1) + v * (2 * b - 1);
        const Vec3 towards = target - hit.point;
        const double weight = -hit.normal.dot(towards) * facing.dot(towards);
        if (hit.normal.dot(towards) <= 0 || weight <= 0) continue;
        const double inverse = 1 / towards.squaredNorm();
        weights += weight * inverse * inverse;
        if (tracer.sees(hit.point + hit.normal * 1e-3, target)) seen += weight * inverse * inverse;
      }
      if (weights > 0) sum += light.radiance * (open * seen / weights);
    }
    return sum;
  }

  Rgb sunlight(const Hit& hit, Random& random) const {
    const Vec3& middle = world.sun->towards;
    const Vec3 side = middle.cross(Vec3::UnitZ()).normalized(), up = side.cross(middle);
    const double radius = kSunRadiusRad * std::sqrt(random.uniform()),
                 angle = 2 * std::numbers::pi * random.uniform();
    const Vec3 towards = middle + radius * (std::cos(angle) * side + std::sin(angle) * up);
    return indirect->sunlight(hit.point, hit.normal, towards.normalized());
  }

  Rgb mirrored(const Hit& hit, const Vec3& ray) const {
    const Vec3 onwards = (ray - 2 * hit.normal.dot(ray) * hit.normal).normalized();
    const auto met = tracer.nearest(hit.point + 1e-3 * hit.normal, onwards);
    if (!met) return indirect ? sky(onwards, true) : Rgb::Zero();
    const Finish look = finish(world, *met, 0.02);
    const Rgb light =
        indirect ? Rgb(indirect->at(*met) + indirect->sunlight(met->point, met->normal, world.sun->towards))
                 : ambient(met->normal);
    return look.albedo * light + look.emission;
  }

  Rgb radiance(const Vec3& eye, const Vec3& ray, double pixel_angle, Random& random, int stratum,
               int strata) const {
    const std::optional<Hit> hit = tracer.nearest(eye, ray);
    if (!hit) return indirect ? sky(ray, true) : Rgb::Zero();
    // Geometric mean of the pixel's two extents on the slanted surface: blurs neither too much nor too
    // little.
    const double slant = std::max(0.05, std::abs(hit->normal.dot(ray)));
    const double footprint = pixel_angle * hit->distance_m / std::sqrt(slant);
    const Finish look = finish(world, *hit, footprint);
    const Rgb light = indirect ? Rgb(sunlight(*hit, random) + indirect->at(*hit)) : ambient(hit->normal);
    const Rgb matt = look.albedo * (direct(*hit, random, stratum, strata) + light) + look.emission;
    if (look.gloss == 0) return matt;
    const double share = look.gloss + (1 - look.gloss) * std::pow(1 - slant, 5.0);  // Schlick
    return matt + (mirrored(*hit, ray) - matt) * share;
  }
};

}  // namespace

Picture8 render(const World& world, const Tracer& tracer, const IndirectLight* indirect, const Camera& camera,
                const RenderOptions& options) {
  const Shader shader{world, tracer, indirect, options.light_samples};
  const Development& develop = options.development;
  const int side = options.samples_per_pixel_side, strata = side * side;
  Picture8 picture{camera.width_px, camera.height_px, {}};
  picture.rgb.resize(3 * static_cast<std::size_t>(camera.width_px) *
                     static_cast<std::size_t>(camera.height_px));
  tbb::parallel_for(0, camera.height_px, [&](int row) {
    for (int column = 0; column < camera.width_px; ++column) {
      const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width_px) +
                                static_cast<std::size_t>(column);
      Random random(options.seed, purpose::pixel + 100 * (options.picture_index + 1), pixel);
      Rgb sum = Rgb::Zero();
      for (int s = 0; s < strata; ++s) {
        const double x = column + (s % side + 0.5) / side, y = row + (s / side + 0.5) / side;
        sum += shader.radiance(camera.eye, camera.ray_direction(x, y), 1 / camera.focal_px / side, random, s,
                               strata);
      }
      Rgb colour = sum * (camera.exposure / strata) * develop.gain *
                   develop.corner_share(camera, column + 0.5, row + 0.5);
      if (develop.noise) {
        Random sensor(options.seed, purpose::sensor + 100 * (options.picture_index + 1), pixel);
        // Read noise plus photon noise, about 1.5 grey levels in the middle greys.
        for (double& c : colour) c += std::sqrt(4e-7 + 2.5e-5 * std::max(0.0, c)) * 1.5 * sensor.normal();
      }
      for (int k = 0; k < 3; ++k) picture.rgb[3 * pixel + static_cast<std::size_t>(k)] = encode(colour[k]);
    }
  });
  return picture;
}

}  // namespace synth
