#include "stages/rendering/free_space.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

// Sees to all sides; its pixels do not matter.
Photograph looking_around(const Vec3& from) {
  Photograph photograph;
  Camera& c = photograph.camera;
  c.width = 64, c.height = 32;
  c.fx = c.width / (2 * M_PI), c.fy = c.height / M_PI;
  c.cx = c.width / 2.0, c.cy = c.height / 2.0;
  c.lens = Lens::spherical;
  photograph.cam_from_world.translation = -from;
  return photograph;
}

}  // namespace

std::vector<std::uint8_t> in_free_space(Renderer& renderer, const RenderScene& scene,
                                        const std::vector<Vec3>& places, double clearance_m) {
  std::vector<Vec3> observers = scene.scanners;
  for (const Photograph& photograph : scene.photographs) observers.push_back(photograph.centre());
  const std::vector<Vec3> around = {Vec3::Zero(),   Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(),
                                    -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
  std::vector<std::uint8_t> free(places.size(), 0);
  for (const Vec3& observer : observers) {
    std::vector<SurfacePoint> points;
    for (const Vec3& place : places)
      for (const Vec3& step : around) {
        const Vec3 point = place + clearance_m * step;
        points.push_back({point, (observer - point).normalized()});
      }
    const auto seen = renderer.seen_from({looking_around(observer)}, points).front();
    std::vector<std::size_t> in_sight(places.size(), 0);
    for (const std::uint32_t i : seen) ++in_sight[i / around.size()];
    for (std::size_t i = 0; i < places.size(); ++i) free[i] |= in_sight[i] == around.size();
  }
  return free;
}

}  // namespace hybrid::stages
