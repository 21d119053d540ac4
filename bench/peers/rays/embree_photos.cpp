#include <half.h>

#include <algorithm>
#include <cmath>

#include "rays/embree_rays.hpp"

namespace hybrid::peers {
namespace {

// Off the surface, so that it does not shadow itself: as far as our kernel ignores hits, by what the point
// lies on.
float lift_m(std::uint32_t id) {
  return id & 0x80000000u ? 0.02f : 0.001f;
}

struct Seen {
  float column, row, weight;
};

float length_of(const float v[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// Where the photograph has the point and what it weighs; weight 0: outside, behind or facing away.
Seen look(const EmbreeScene::Photographs& photographs, const Pinhole& camera, const float* p,
          const float* normal) {
  float local[3], to_camera[3], to_eye[3];
  for (int k = 0; k < 3; ++k) {
    to_camera[k] = camera.centre[k] - p[k];
    to_eye[k] = photographs.eye[k] - p[k];
  }
  const float* m = camera.rotation;
  for (int k = 0; k < 3; ++k)
    local[k] = -(m[3 * k] * to_camera[0] + m[3 * k + 1] * to_camera[1] + m[3 * k + 2] * to_camera[2]);
  const float facing = to_camera[0] * normal[0] + to_camera[1] * normal[1] + to_camera[2] * normal[2];
  if (!(local[2] > 0) || !(facing > 0)) return {0, 0, 0};
  const float x = local[0] / local[2], y = local[1] / local[2], radial = 1 + camera.k1 * (x * x + y * y);
  const float column = camera.fx * x * radial + camera.cx, row = camera.fy * y * radial + camera.cy;
  const float border = std::min(std::min(column, row), std::min(static_cast<float>(camera.width) - column,
                                                                static_cast<float>(camera.height) - row));
  if (!(border > 0)) return {0, 0, 0};
  const float cosine = (to_camera[0] * to_eye[0] + to_camera[1] * to_eye[1] + to_camera[2] * to_eye[2]) /
                       (length_of(to_camera) * length_of(to_eye));
  const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f));
  return {column, row, std::min(1.0f, border / photographs.feather_px) / (angle + photographs.pixel_rad)};
}

struct Light {
  float low[3], high[3];
};

Light light_at(const EmbreeScene::Photographs& photographs, const Pinhole& camera, float column, float row) {
  const float x = std::clamp(column - 0.5f, 0.0f, static_cast<float>(camera.width - 1)),
              y = std::clamp(row - 0.5f, 0.0f, static_cast<float>(camera.height - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, camera.width - 1),
            y1 = std::min(y0 + 1, camera.height - 1);
  const float right = x - static_cast<float>(x0), below = y - static_cast<float>(y0);
  const int at[4] = {y0 * camera.width + x0, y0 * camera.width + x1, y1 * camera.width + x0,
                     y1 * camera.width + x1};
  const float share[4] = {(1 - right) * (1 - below), right * (1 - below), (1 - right) * below, right * below};
  Light light{};
  for (int k = 0; k < 4; ++k)
    for (int channel = 0; channel < 3; ++channel) {
      const std::size_t i =
          std::size_t{4} * static_cast<std::size_t>(at[k]) + static_cast<std::size_t>(channel);
      light.high[channel] += share[k] * photographs.linear[photographs.pixels[i]];
      light.low[channel] += share[k] * imath_half_to_float(photographs.low[i]);
    }
  for (int channel = 0; channel < 3; ++channel) light.high[channel] -= light.low[channel];
  return light;
}

}  // namespace

// Of up to 16 points from `first` those in `valid` (-1) that see `centre` stay so.
void EmbreeScene::free_rays(const Surface& surface, std::size_t first, int lanes, const float centre[3],
                            RayMode mode, int valid[16]) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  if (mode == RayMode::single) {
    for (int lane = 0; lane < lanes; ++lane) {
      if (!valid[lane]) continue;
      const float* p = surface.point.data() + 3 * (first + static_cast<std::size_t>(lane));
      const float d[3] = {centre[0] - p[0], centre[1] - p[1], centre[2] - p[2]};
      RTCRay ray{p[0], p[1], p[2], lift_m(surface.id[first + static_cast<std::size_t>(lane)]) / length_of(d),
                 d[0], d[1], d[2], 0,
                 1,    ~0u,  0,    0};
      rtcOccluded1(scene_, &context, &ray);
      if (ray.tfar < 0) valid[lane] = 0;
    }
    return;
  }
  RTCRay16 rays;
  for (int lane = 0; lane < 16; ++lane) {
    const bool used = lane < lanes && valid[lane];
    const std::size_t i = first + static_cast<std::size_t>(used ? lane : 0);
    const float* p = surface.point.data() + 3 * i;
    const float d[3] = {centre[0] - p[0], centre[1] - p[1], centre[2] - p[2]};
    if (!used) valid[lane] = 0;
    rays.org_x[lane] = p[0], rays.org_y[lane] = p[1], rays.org_z[lane] = p[2];
    rays.dir_x[lane] = d[0], rays.dir_y[lane] = d[1], rays.dir_z[lane] = d[2];
    rays.tnear[lane] = used ? lift_m(surface.id[i]) / length_of(d) : 0, rays.tfar[lane] = 1;
    rays.time[lane] = 0, rays.mask[lane] = ~0u, rays.id[lane] = 0, rays.flags[lane] = 0;
  }
  rtcOccluded16(valid, scene_, &context, &rays);
  for (int lane = 0; lane < 16; ++lane)
    if (valid[lane] && rays.tfar[lane] < 0) valid[lane] = 0;
}

std::size_t EmbreeScene::shadow(const Surface& surface, const std::vector<Pinhole>& cameras,
                                RayMode mode) const {
  std::size_t free = 0;
  const auto groups = static_cast<std::ptrdiff_t>((surface.count + 15) / 16);
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : free)
  for (std::ptrdiff_t group = 0; group < groups; ++group) {
    const auto first = std::size_t{16} * static_cast<std::size_t>(group);
    const int lanes = static_cast<int>(std::min<std::size_t>(16, surface.count - first));
    for (const Pinhole& camera : cameras) {
      alignas(64) int valid[16] = {};
      for (int lane = 0; lane < lanes; ++lane)
        valid[lane] = surface.id[first + static_cast<std::size_t>(lane)] ? -1 : 0;
      free_rays(surface, first, lanes, camera.centre, mode, valid);
      for (int lane = 0; lane < lanes; ++lane) free += valid[lane] != 0;
    }
  }
  return free;
}

void EmbreeScene::blend(const Surface& surface, const Photographs& photographs, RayMode mode,
                        std::vector<float>& sums, std::vector<std::uint32_t>& seen) const {
  const auto groups = static_cast<std::ptrdiff_t>((surface.count + 15) / 16);
#pragma omp parallel for schedule(dynamic, 256)
  for (std::ptrdiff_t group = 0; group < groups; ++group) {
    const auto first = std::size_t{16} * static_cast<std::size_t>(group);
    const int lanes = static_cast<int>(std::min<std::size_t>(16, surface.count - first));
    float heaviest[16] = {};
    for (const Pinhole& camera : photographs.cameras) {
      alignas(64) int valid[16] = {};
      Seen sight[16];
      bool any = false;
      for (int lane = 0; lane < lanes; ++lane) {
        const std::size_t i = first + static_cast<std::size_t>(lane);
        if (!surface.id[i]) continue;
        sight[lane] = look(photographs, camera, surface.point.data() + 3 * i, surface.normal.data() + 3 * i);
        valid[lane] = sight[lane].weight > 0 ? -1 : 0;
        any |= valid[lane] != 0;
      }
      if (!any) continue;
      free_rays(surface, first, lanes, camera.centre, mode, valid);
      for (int lane = 0; lane < lanes; ++lane) {
        if (!valid[lane]) continue;
        const std::size_t i = first + static_cast<std::size_t>(lane);
        const float weight = sight[lane].weight;
        const Light light = light_at(photographs, camera, sight[lane].column, sight[lane].row);
        // High bands relative to the heaviest so far: the eighth power would leave the range of floats.
        const auto eighth = [](float x) { return x *= x, x *= x, x * x; };
        const float kept = weight > heaviest[lane] ? eighth(heaviest[lane] / weight) : 1,
                    added = weight > heaviest[lane] ? 1 : eighth(weight / heaviest[lane]);
        heaviest[lane] = std::max(heaviest[lane], weight);
        float* out = sums.data() + 8 * i;
        for (int k = 0; k < 3; ++k) {
          out[k] += weight * light.low[k];
          out[4 + k] = kept * out[4 + k] + added * light.high[k];
        }
        out[3] += weight;
        out[7] = kept * out[7] + added;
        ++seen[i];
      }
    }
  }
}

}  // namespace hybrid::peers
