#include "room/coverage.hpp"

#include <algorithm>

namespace synth {

std::array<double, 3> seen_shares(const Room& room, const Tracer& tracer, const Surface& surface,
                                  const std::vector<Camera>& photographs) {
  constexpr double step_m = 0.05;
  const Vec3 half = surface.centre - surface.origin;
  const double width = 2 * half.dot(surface.u_axis), height = 2 * half.dot(surface.v_axis);
  const auto in_an_opening = [&](const Vec3& p) {
    return std::any_of(room.recesses.begin(), room.recesses.end(), [&](const Recess& r) {
      const auto ring = r.ring(room.size);
      const Vec3 low = ring[0].cwiseMin(ring[2]), high = ring[0].cwiseMax(ring[2]);
      return r.wall == surface.name && (p - low).minCoeff() >= -1e-9 && (high - p).minCoeff() >= -1e-9;
    });
  };
  std::array<double, 3> counts{};
  for (double v = step_m / 2; v < height; v += step_m) {
    for (double u = step_m / 2; u < width; u += step_m) {
      const Vec3 point = surface.origin + u * surface.u_axis + v * surface.v_axis;
      if (in_an_opening(point)) continue;
      const auto seen = std::count_if(photographs.begin(), photographs.end(), [&](const Camera& camera) {
        return camera.project(point) && tracer.sees(point + 1e-3 * surface.normal, camera.eye);
      });
      counts[static_cast<std::size_t>(std::min<std::ptrdiff_t>(seen, 2))] += 1;
    }
  }
  const double total = counts[0] + counts[1] + counts[2];
  for (double& count : counts) count /= std::max(1.0, total);
  return counts;
}

}  // namespace synth
