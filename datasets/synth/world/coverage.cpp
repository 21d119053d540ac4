#include "world/coverage.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace synth {

std::array<double, 3> seen_shares(const World& world, const Tracer& tracer, const Surface& surface) {
  const Vec3 half = surface.centre - surface.origin;
  const double width = 2 * half.dot(surface.u_axis), height = 2 * half.dot(surface.v_axis);
  const double step_m = std::max(0.05, std::sqrt(width * height) / 120);
  const auto rows = static_cast<std::size_t>(std::max(0.0, std::ceil(height / step_m - 0.5)));
  const auto on_the_surface = [&](const Vec3& point) {
    const auto hit = tracer.nearest(point + 1e-3 * surface.normal, -surface.normal);
    return hit && &world.mesh.surfaces[hit->surface] == &surface;
  };
  std::vector<std::array<double, 3>> counts_of_row(rows, {0, 0, 0});
  tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
    const double v = step_m * (static_cast<double>(row) + 0.5);
    for (double u = step_m / 2; u < width; u += step_m) {
      const Vec3 point = surface.origin + u * surface.u_axis + v * surface.v_axis;
      if (!on_the_surface(point)) continue;
      const auto seen =
          std::count_if(world.photographs.begin(), world.photographs.end(), [&](const Camera& camera) {
            return camera.project(point) && tracer.sees(point + 1e-3 * surface.normal, camera.eye);
          });
      counts_of_row[row][static_cast<std::size_t>(std::min<std::ptrdiff_t>(seen, 2))] += 1;
    }
  });
  std::array<double, 3> counts{};
  for (const auto& row : counts_of_row)
    for (std::size_t k = 0; k < 3; ++k) counts[k] += row[k];
  const double total = counts[0] + counts[1] + counts[2];
  for (double& count : counts) count /= std::max(1.0, total);
  return counts;
}

}  // namespace synth
