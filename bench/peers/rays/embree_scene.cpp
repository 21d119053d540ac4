#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "rays/embree_rays.hpp"

namespace hybrid::peers {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void direction_of(const Pinhole& camera, int col, int row, float out[3]) {
  const float x = (static_cast<float>(col) + 0.5f - camera.cx) / camera.fx,
              y = (static_cast<float>(row) + 0.5f - camera.cy) / camera.fy;
  const float length = std::sqrt(x * x + y * y + 1);
  const float* m = camera.rotation;
  for (int k = 0; k < 3; ++k) out[k] = (m[k] * x + m[3 + k] * y + m[6 + k]) / length;
}

// Fills pixel i from a hit at `t` along `d`.
void store(Surface& out, std::size_t i, const float origin[3], const float d[3], float t,
           const float normal[3], std::uint32_t id) {
  out.distance[i] = id ? t : kInfinity;
  out.id[i] = id;
  const float length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  const bool away = normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2] > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    out.point[3 * i + k] = id ? origin[k] + t * d[k] : NAN;
    out.normal[3 * i + k] = id ? (away ? -normal[k] : normal[k]) / length : 0;
  }
}

}  // namespace

EmbreeScene::EmbreeScene(const Geometry& geometry)
    : device_(rtcNewDevice(nullptr)),
      scene_(rtcNewScene(device_)),
      corners_(geometry.corners),
      ids_(geometry.ids) {
  if (!device_) throw std::runtime_error("Embree: no device");
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  const auto count = static_cast<unsigned>(ids_.size());
  RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), std::size_t{3} * count));
  auto* corners = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count));
  std::copy(corners_.begin(), corners_.end(), vertices);
  for (unsigned i = 0; i < 3 * count; ++i) corners[i] = i;
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene_, mesh);
  rtcReleaseGeometry(mesh);
  if (!geometry.spheres.empty()) {
    RTCGeometry spheres = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* values =
        static_cast<float*>(rtcSetNewGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                    4 * sizeof(float), geometry.spheres.size() / 4));
    std::copy(geometry.spheres.begin(), geometry.spheres.end(), values);
    rtcCommitGeometry(spheres);
    spheres_geometry_ = rtcAttachGeometry(scene_, spheres);
    rtcReleaseGeometry(spheres);
  }
  rtcCommitScene(scene_);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::cast(const Pinhole& camera, RayMode mode, Surface& out) const {
  out.count = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  out.distance.resize(out.count);
  out.id.resize(out.count);
  out.point.resize(3 * out.count);
  out.normal.resize(3 * out.count);
  const auto id_of = [&](unsigned geometry, unsigned primitive) -> std::uint32_t {
    if (geometry == RTC_INVALID_GEOMETRY_ID) return 0;
    return geometry == spheres_geometry_ ? 0x80000000u + primitive : ids_[primitive];
  };
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < camera.height; ++row) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (int col = 0; col < camera.width; col += 16) {
      const int lanes = std::min(16, camera.width - col);
      const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width) +
                         static_cast<std::size_t>(col);
      if (mode == RayMode::single) {
        for (int lane = 0; lane < lanes; ++lane) {
          RTCRayHit ray{};
          float d[3];
          direction_of(camera, col + lane, row, d);
          ray.ray = {camera.centre[0],
                     camera.centre[1],
                     camera.centre[2],
                     0,
                     d[0],
                     d[1],
                     d[2],
                     0,
                     kInfinity,
                     ~0u,
                     0,
                     0};
          ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
          rtcIntersect1(scene_, &context, &ray);
          const float normal[3] = {ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z};
          store(out, first + static_cast<std::size_t>(lane), camera.centre, d, ray.ray.tfar, normal,
                id_of(ray.hit.geomID, ray.hit.primID));
        }
        continue;
      }
      RTCRayHit16 rays;
      alignas(64) int valid[16];
      for (int lane = 0; lane < 16; ++lane) {
        float d[3] = {0, 0, 1};
        valid[lane] = lane < lanes ? -1 : 0;
        if (lane < lanes) direction_of(camera, col + lane, row, d);
        rays.ray.org_x[lane] = camera.centre[0], rays.ray.org_y[lane] = camera.centre[1];
        rays.ray.org_z[lane] = camera.centre[2], rays.ray.tnear[lane] = 0, rays.ray.tfar[lane] = kInfinity;
        rays.ray.dir_x[lane] = d[0], rays.ray.dir_y[lane] = d[1], rays.ray.dir_z[lane] = d[2];
        rays.ray.time[lane] = 0, rays.ray.mask[lane] = ~0u, rays.ray.id[lane] = 0, rays.ray.flags[lane] = 0;
        rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid, scene_, &context, &rays);
      for (int lane = 0; lane < lanes; ++lane) {
        const float d[3] = {rays.ray.dir_x[lane], rays.ray.dir_y[lane], rays.ray.dir_z[lane]},
                    normal[3] = {rays.hit.Ng_x[lane], rays.hit.Ng_y[lane], rays.hit.Ng_z[lane]};
        store(out, first + static_cast<std::size_t>(lane), camera.centre, d, rays.ray.tfar[lane], normal,
              id_of(rays.hit.geomID[lane], rays.hit.primID[lane]));
      }
    }
  }
}

namespace {

struct Nearest {
  const float* corners;
  float query[3];
  float distance2;
};

// Squared distance to a triangle (Ericson, Real-Time Collision Detection, 5.1.5: by Voronoi regions).
float distance2_to(const float* a, const float* b, const float* c, const float* p) {
  const auto minus = [](const float* u, const float* v, float* w) {
    for (int k = 0; k < 3; ++k) w[k] = u[k] - v[k];
  };
  const auto dot = [](const float* u, const float* v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; };
  float ab[3], ac[3], ap[3], bp[3], cp[3];
  minus(b, a, ab), minus(c, a, ac), minus(p, a, ap), minus(p, b, bp), minus(p, c, cp);
  const float d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
              d6 = dot(ac, cp);
  const float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  float v = 0, w = 0;
  if (d1 <= 0 && d2 <= 0) {
  } else if (d3 >= 0 && d4 <= d3) {
    v = 1;
  } else if (d6 >= 0 && d5 <= d6) {
    w = 1;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    v = d1 / (d1 - d3);
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    w = d2 / (d2 - d6);
  } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    w = (d4 - d3) / (d4 - d3 + d5 - d6);
    v = 1 - w;
  } else {
    const float sum = va + vb + vc;
    v = vb / sum;
    w = vc / sum;
  }
  float off[3];
  for (int k = 0; k < 3; ++k) off[k] = ap[k] - v * ab[k] - w * ac[k];
  return dot(off, off);
}

bool visit(RTCPointQueryFunctionArguments* arguments) {
  auto* nearest = static_cast<Nearest*>(arguments->userPtr);
  const float* t = nearest->corners + std::size_t{9} * arguments->primID;
  const float found = distance2_to(t, t + 3, t + 6, nearest->query);
  if (found >= nearest->distance2) return false;
  nearest->distance2 = found;
  arguments->query->radius = std::sqrt(found);
  return true;
}

}  // namespace

void EmbreeScene::closest(const std::vector<float>& queries, float radius_m,
                          std::vector<float>& distance) const {
  const auto count = static_cast<std::ptrdiff_t>(queries.size() / 3);
  distance.resize(static_cast<std::size_t>(count));
#pragma omp parallel for schedule(dynamic, 4096)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const float* p = queries.data() + 3 * i;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Nearest nearest{corners_.data(), {p[0], p[1], p[2]}, radius_m * radius_m};
    RTCPointQuery query{p[0], p[1], p[2], 0, radius_m};
    if (std::isfinite(p[0])) rtcPointQuery(scene_, &query, &context, visit, &nearest);
    distance[static_cast<std::size_t>(i)] =
        nearest.distance2 < radius_m * radius_m ? std::sqrt(nearest.distance2) : kInfinity;
  }
}

}  // namespace hybrid::peers
