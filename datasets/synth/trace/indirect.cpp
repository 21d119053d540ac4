#include "trace/indirect.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "surface/material.hpp"
#include "trace/sky.hpp"

namespace synth {
namespace {

// What further bounces add, indoors; and what a pane sends in: its mean, far brighter than it looks in
// pictures, whose range of brightness is small.
const Rgb kInside(0.085, 0.080, 0.072), kPaneLight(1.05, 0.98, 0.92);
constexpr double kBounceAlbedo = 0.42, kBuriedShare = 0.3;
const Rgb kPaneTint = Rgb::Constant(0.75);

}  // namespace

IndirectLight::IndirectLight(const World& world, const Tracer& tracer, double step_m, int rays)
    : world_(world), tracer_(tracer), step_m_(step_m), rays_(rays) {
  grid_of_surface_.resize(world.mesh.surfaces.size());
  tbb::parallel_for(std::size_t{0}, world.mesh.surfaces.size(), [&](std::size_t s) {
    if (world.mesh.surfaces[s].shape == Shape::plane)
      grid_of_surface_[s] = gather_grid(static_cast<std::uint32_t>(s));
  });
  gather_vertices();
}

Rgb IndirectLight::sunlight(const Vec3& point, const Vec3& normal, const Vec3& towards) const {
  const double cosine = normal.dot(towards);
  if (cosine <= 0) return Rgb::Zero();
  const Vec3 start = point + 1e-3 * normal;
  if (tracer_.solid_blocks(start, towards)) return Rgb::Zero();
  Rgb light = world_.sun->irradiance * cosine;
  // The ray leaves through the pane's outer side and finds its inner one first.
  if (const auto pane = tracer_.nearest_glass(start, towards))
    light *= finish(world_, *pane, 0.03).emission * 2 * kPaneTint;
  return light;
}

// False: the point lies inside something.
bool IndirectLight::gather(const Vec3& point, const Vec3& normal, std::uint64_t pattern, Rgb& sum) const {
  const Vec3 side = normal.cross(std::abs(normal.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized();
  const Vec3 up = normal.cross(side);
  Random turn(pattern, purpose::pixel);
  const double first = turn.uniform();
  int buried = 0;
  sum = Rgb::Zero();
  for (int k = 0; k < rays_; ++k) {
    // Cosine-weighted Fibonacci spiral.
    const double radius = std::sqrt((k + 0.5) / rays_),
                 angle = 2 * std::numbers::pi * std::fmod(first + k * 0.6180339887498949, 1.0);
    const Vec3 direction = (radius * std::cos(angle) * side + radius * std::sin(angle) * up +
                            std::sqrt(1 - radius * radius) * normal)
                               .normalized();
    const auto hit = tracer_.nearest(point + 2e-3 * normal, direction);
    if (!hit) {
      sum += sky(direction, false);
      continue;
    }
    const Surface& surface = world_.mesh.surfaces[hit->surface];
    if (hit->normal.dot(direction) > 0.02) ++buried;
    if (surface.material == Material::stained_glass) {
      sum += kPaneLight;
      continue;
    }
    const bool inside = world_.interior && world_.interior->contains(hit->point);
    const Rgb around = inside ? kInside : Rgb(0.5 * sky(Vec3::UnitZ(), false) + 0.12);
    sum += kBounceAlbedo * (around + sunlight(hit->point, hit->normal, world_.sun->towards));
  }
  sum /= rays_;
  if (world_.interior && world_.interior->contains(point)) sum += 0.5 * kInside;
  return buried < kBuriedShare * rays_;
}

IndirectLight::Grid IndirectLight::gather_grid(std::uint32_t index) const {
  const Surface& surface = world_.mesh.surfaces[index];
  const Vec3 half = surface.centre - surface.origin;
  const double width = 2 * half.dot(surface.u_axis), height = 2 * half.dot(surface.v_axis);
  const double step = std::max(step_m_, std::sqrt(width * height) / 90);
  Grid grid;
  grid.left = std::min(0.02, width / 4);
  grid.bottom = std::min(0.02, height / 4);
  grid.columns = 2 + static_cast<int>(width / step);
  grid.rows = 2 + static_cast<int>(height / step);
  grid.step_u = (width - 2 * grid.left) / (grid.columns - 1);
  grid.step_v = (height - 2 * grid.bottom) / (grid.rows - 1);
  grid.nodes.resize(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  std::vector<char> known(grid.nodes.size());
  tbb::parallel_for(0, grid.rows, [&](int row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto node = static_cast<std::size_t>(row * grid.columns + column);
      const Vec3 point = surface.origin + (grid.left + column * grid.step_u) * surface.u_axis +
                         (grid.bottom + row * grid.step_v) * surface.v_axis;
      known[node] = gather(point, surface.normal, index, grid.nodes[node]);
    }
  });
  // Nodes inside a wall or a column take what their neighbours have, ring by ring.
  for (int pass = 0; pass < 4; ++pass) {
    const std::vector<char> before = known;
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        const auto node = static_cast<std::size_t>(row * grid.columns + column);
        if (before[node]) continue;
        Rgb sum = Rgb::Zero();
        int count = 0;
        for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
          for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) {
            const auto other = static_cast<std::size_t>(r * grid.columns + c);
            if (!before[other]) continue;
            sum += grid.nodes[other];
            ++count;
          }
        }
        if (count == 0) continue;
        grid.nodes[node] = sum / count;
        known[node] = 1;
      }
    }
  }
  return grid;
}

void IndirectLight::gather_vertices() {
  const Mesh& mesh = world_.mesh;
  vertices_.assign(mesh.vertices.size(), Rgb::Zero());
  std::vector<std::uint32_t> surface_of_vertex(mesh.vertices.size(), ~0u);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.surfaces[mesh.surface_of_triangle[i]].shape == Shape::plane) continue;
    for (std::uint32_t corner : mesh.triangles[i]) surface_of_vertex[corner] = mesh.surface_of_triangle[i];
  }
  tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t v) {
    if (surface_of_vertex[v] == ~0u) return;
    const Surface& surface = mesh.surfaces[surface_of_vertex[v]];
    const Vec3 point = mesh.vertices[v].cast<double>();
    const Vec3 normal =
        surface.shape == Shape::free ? mesh.normals[v].cast<double>() : surface.smooth_normal(point);
    gather(point, normal, surface_of_vertex[v], vertices_[v]);
  });
}

Rgb IndirectLight::at(const Hit& hit) const {
  const Surface& surface = world_.mesh.surfaces[hit.surface];
  if (surface.shape != Shape::plane) {
    const auto& corner = world_.mesh.triangles[hit.triangle];
    return (1.0 - hit.second - hit.third) * vertices_[corner[0]] + hit.second * vertices_[corner[1]] +
           hit.third * vertices_[corner[2]];
  }
  const Grid& grid = grid_of_surface_[hit.surface];
  const Vec3 from = hit.point - surface.origin;
  const double x = std::clamp((from.dot(surface.u_axis) - grid.left) / grid.step_u, 0.0,
                              static_cast<double>(grid.columns - 1)),
               y = std::clamp((from.dot(surface.v_axis) - grid.bottom) / grid.step_v, 0.0,
                              static_cast<double>(grid.rows - 1));
  const int i = std::min(grid.columns - 2, static_cast<int>(x)),
            j = std::min(grid.rows - 2, static_cast<int>(y));
  const auto node = [&](int c, int r) { return grid.nodes[static_cast<std::size_t>(r * grid.columns + c)]; };
  const Rgb low = blend(node(i, j), node(i + 1, j), x - i),
            high = blend(node(i, j + 1), node(i + 1, j + 1), x - i);
  return blend(low, high, y - j);
}

}  // namespace synth
