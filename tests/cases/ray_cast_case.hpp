#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_ray_cast.h"
#include "stages/rendering/bvh.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::testing {

// Triangles and spheres in a cube of 10 m, for every kernel that casts rays.
struct RayScene {
  std::vector<TriangleRecord> triangles;
  std::vector<SphereRecord> spheres;
  std::vector<SphereSurface> surfaces;

  static RayScene make(std::size_t triangles, std::size_t spheres, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-5, 5), edge(-1.5f, 1.5f), size(0.02f, 0.4f);
    RayScene scene;
    for (std::size_t i = 0; i < triangles; ++i) {
      TriangleRecord t{};
      for (int k = 0; k < 3; ++k) {
        t.a[k] = place(random);
        t.b[k] = t.a[k] + edge(random);
        t.c[k] = t.a[k] + edge(random);
      }
      t.id = 1 + static_cast<std::uint32_t>(i);
      t.radius = i % 3 == 0 ? 1e-6f : 0.0f;
      scene.triangles.push_back(t);
    }
    for (std::size_t i = 0; i < spheres; ++i) {
      scene.spheres.push_back({{place(random), place(random), place(random)}, size(random)});
      // Every other splat has a normal.
      const float x = edge(random), y = edge(random), z = edge(random),
                  length = std::sqrt(x * x + y * y + z * z);
      SphereSurface surface{{x / length, y / length, z / length},
                            0x80000000u + static_cast<std::uint32_t>(i)};
      if (i % 2) surface.normal[0] = surface.normal[1] = surface.normal[2] = 0;
      scene.surfaces.push_back(surface);
    }
    return scene;
  }
};

struct RayCastCase {
  static constexpr const char* kName = "ray_cast";
  struct Input {
    RayScene scene;
    std::array<float, 3> origin{};
    std::vector<float> origins;     // 3 per group of as many rays each; none = `origin` for all
    std::vector<float> directions;  // 3 per ray; every 13th is NaN
    float tolerance_m = 0.3f;       // large, so that the rule decides often
    int vector_width = 0;           // 0 = the device's
    std::size_t count() const { return directions.size() / 3; }
  };
  struct Output {
    std::vector<float> distance;
    std::vector<std::uint32_t> id;
    std::vector<float> surface;
  };

  // Rays from a point inside the cloud of primitives, in all directions.
  static Input make(std::size_t size, std::uint32_t seed) {
    Input input;
    input.scene = RayScene::make(150, 150, seed);
    input.origin = {0.3f, -0.2f, 0.1f};
    std::mt19937 random(seed + 1);
    std::normal_distribution<float> part;
    for (std::size_t i = 0; i < size; ++i) {
      const float x = part(random), y = part(random), z = part(random),
                  length = std::sqrt(x * x + y * y + z * z);
      const float none = i % 13 == 12 ? std::numeric_limits<float>::quiet_NaN() : 1.0f;
      input.directions.insert(input.directions.end(), {none * x / length, y / length, z / length});
    }
    return input;
  }

  static Output run(device::Queue& queue, const Input& input) {
    const auto bvh = stages::upload_bvh(queue, stages::build_bvh(input.scene.triangles, input.scene.spheres),
                                        input.scene.surfaces);
    const int width = input.vector_width ? input.vector_width : queue.vector_width();
    RayCastParams params{};
    for (int k = 0; k < 3; ++k) params.camera.centre[k] = input.origin[static_cast<std::size_t>(k)];
    params.cols = static_cast<std::uint32_t>(input.count());
    params.rows = 1;
    params.tolerance_m = input.tolerance_m;
    params.root = bvh.root;
    params.want_surface = 1;
    if (!input.origins.empty())
      params.rays_per_origin = static_cast<std::uint32_t>(3 * input.count() / input.origins.size());
    auto given = input.directions;
    given.insert(given.end(), input.origins.begin(), input.origins.end());
    const auto directions = queue.array(given);
    const auto distance = queue.array<float>(input.count());
    const auto id = queue.array<std::uint32_t>(input.count());
    const auto surface = queue.array<float>(SURFACE_PLANES * input.count());
    queue.launch(kName, queue.kernel(kName, {{"VW", width}}), stages::packet_grid(width, input.count(), 1),
                 params, bvh.nodes, bvh.triangles, bvh.spheres, bvh.surfaces, directions, distance, id,
                 surface);
    return {queue.read(distance), queue.read(id), queue.read(surface)};
  }
  static Output reference(const Input& input);  // reference/ray_cast.cpp

  // Whether a ray's result agrees. Directions are rounded to 6e-8, so a hit 10 m away at grazing incidence
  // moves by micrometres: 1e-4 m + 1e-4 of the distance covers incidence up to 89 degrees.
  static bool agrees(const Output& got, const Output& expected, std::size_t i) {
    if (got.id[i] != expected.id[i]) return false;
    if (got.id[i] == 0) return std::isinf(got.distance[i]) && std::isnan(got.surface[i]);
    const std::size_t count = got.id.size();
    const float tolerance = 1e-4f * (1 + expected.distance[i]);
    if (!(std::abs(got.distance[i] - expected.distance[i]) < tolerance)) return false;
    for (std::size_t plane = SURFACE_X; plane <= SURFACE_Z; ++plane)
      if (!(std::abs(got.surface[plane * count + i] - expected.surface[plane * count + i]) < tolerance))
        return false;
    // A sphere's own normal turns by the hit's error over its radius.
    for (std::size_t plane = SURFACE_NORMAL_X; plane <= SURFACE_RADIUS; ++plane)
      if (!(std::abs(got.surface[plane * count + i] - expected.surface[plane * count + i]) < 2e-2f))
        return false;
    return true;
  }
  // Rays through an edge, past a sphere's rim or at the tolerance itself may be decided either way.
  static constexpr double kUndecided = 1e-4;

  static double items(const Input& input) { return static_cast<double>(input.count()); }
  static double bytes(const Input& input) { return 48.0 * items(input); }
  static double flops(const Input& input) { return 1000.0 * items(input); }
};

}  // namespace hybrid::testing
