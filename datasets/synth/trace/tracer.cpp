#include "trace/tracer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace synth {
namespace {

RTCRay make_ray(const Vec3& origin, const Vec3& direction, double near_m, double far_m) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = static_cast<float>(near_m);
  ray.tfar = static_cast<float>(far_m);
  ray.mask = ~0u;
  return ray;
}

}  // namespace

Tracer::Tracer(const Mesh& mesh) : mesh_(mesh), device_(rtcNewDevice(nullptr)) {
  if (!device_) throw std::runtime_error("Embree: no device");
  solid_ = make_part(false);
  glass_ = make_part(true);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree: building the scene failed");
}

Tracer::~Tracer() {
  rtcReleaseScene(solid_.scene);
  rtcReleaseScene(glass_.scene);
  rtcReleaseDevice(device_);
}

Tracer::Part Tracer::make_part(bool glass) const {
  Part part;
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
    if (is_glass(mesh_.surfaces[mesh_.surface_of_triangle[i]].material) == glass)
      part.triangles.push_back(static_cast<std::uint32_t>(i));
  part.scene = rtcNewScene(device_);
  rtcSetSceneFlags(part.scene, RTC_SCENE_FLAG_ROBUST);  // no rays through shared edges
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh_.vertices.size()));
  for (const Eigen::Vector3f& v : mesh_.vertices) vertices = std::copy_n(v.data(), 3, vertices);
  if (!part.triangles.empty()) {
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), part.triangles.size()));
    for (std::uint32_t i : part.triangles) corners = std::copy_n(mesh_.triangles[i].data(), 3, corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(part.scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  rtcCommitScene(part.scene);
  return part;
}

std::optional<Hit> Tracer::nearest_in(const Part& part, const Vec3& origin,
                                      const Vec3& unit_direction) const {
  if (part.triangles.empty()) return std::nullopt;
  RTCRayHit query{};
  query.ray = make_ray(origin, unit_direction, 0, std::numeric_limits<double>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(part.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  Hit hit;
  hit.triangle = part.triangles[query.hit.primID];
  hit.second = query.hit.u;
  hit.third = query.hit.v;
  hit.surface = mesh_.surface_of_triangle[hit.triangle];
  const Surface& surface = mesh_.surfaces[hit.surface];
  const auto& corner = mesh_.triangles[hit.triangle];
  const Vec3 a = mesh_.vertices[corner[0]].cast<double>();
  const bool is_plane = surface.shape == Shape::plane;
  const Vec3 facet = is_plane ? surface.normal
                              : (mesh_.vertices[corner[1]].cast<double>() - a)
                                    .cross(mesh_.vertices[corner[2]].cast<double>() - a)
                                    .normalized();
  const double offset = is_plane ? surface.offset_m : facet.dot(a);
  hit.distance_m = (offset - facet.dot(origin)) / facet.dot(unit_direction);
  if (!(std::abs(hit.distance_m - query.ray.tfar) < 1e-3))
    hit.distance_m = query.ray.tfar;  // grazing: ill-posed
  hit.point = origin + hit.distance_m * unit_direction;
  if (surface.shape == Shape::free) {
    const float first = 1 - hit.second - hit.third;
    const auto mean = [&](const auto& values) {
      return (first * values[corner[0]] + hit.second * values[corner[1]] + hit.third * values[corner[2]])
          .template cast<double>()
          .eval();
    };
    hit.normal = mean(mesh_.normals).normalized();
    hit.coordinates = mean(mesh_.coordinates);
  } else {
    hit.normal = surface.smooth_normal(hit.point);
  }
  return hit;
}

std::optional<Hit> Tracer::nearest_solid(const Vec3& origin, const Vec3& unit_direction) const {
  return nearest_in(solid_, origin, unit_direction);
}

std::optional<Hit> Tracer::nearest_glass(const Vec3& origin, const Vec3& unit_direction) const {
  return nearest_in(glass_, origin, unit_direction);
}

std::optional<Hit> Tracer::nearest(const Vec3& origin, const Vec3& unit_direction) const {
  const std::optional<Hit> solid = nearest_solid(origin, unit_direction),
                           glass = nearest_glass(origin, unit_direction);
  return glass && (!solid || glass->distance_m < solid->distance_m) ? glass : solid;
}

bool Tracer::sees(const Vec3& from, const Vec3& to) const {
  const double distance = (to - from).norm();
  for (const Part* part : {&solid_, &glass_}) {
    if (part->triangles.empty()) continue;
    RTCRay ray = make_ray(from, (to - from) / distance, 1e-3, distance - 1e-3);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(part->scene, &context, &ray);
    if (ray.tfar < 0) return false;  // Embree marks an occluded ray with -inf
  }
  return true;
}

bool Tracer::solid_blocks(const Vec3& from, const Vec3& unit_direction) const {
  RTCRay ray = make_ray(from, unit_direction, 1e-3, std::numeric_limits<double>::infinity());
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(solid_.scene, &context, &ray);
  return ray.tfar < 0;
}

}  // namespace synth
