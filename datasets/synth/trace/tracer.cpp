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

Tracer::Tracer(const Mesh& mesh) : mesh_(mesh), device_(rtcNewDevice(nullptr)), scene_(nullptr) {
  if (!device_) throw std::runtime_error("Embree: no device");
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);  // no rays through shared edges
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  for (const Eigen::Vector3f& v : mesh.vertices) vertices = std::copy_n(v.data(), 3, vertices);
  auto* corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) corners = std::copy_n(triangle.data(), 3, corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree: building the scene failed");
}

Tracer::~Tracer() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

std::optional<Hit> Tracer::nearest(const Vec3& origin, const Vec3& unit_direction) const {
  RTCRayHit query{};
  query.ray = make_ray(origin, unit_direction, 0, std::numeric_limits<double>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  Hit hit;
  hit.surface = mesh_.surface_of_triangle[query.hit.primID];
  const Surface& surface = mesh_.surfaces[hit.surface];
  const auto& corner = mesh_.triangles[query.hit.primID];
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
  hit.normal = surface.smooth_normal(hit.point);
  return hit;
}

bool Tracer::sees(const Vec3& from, const Vec3& to) const {
  const double distance = (to - from).norm();
  RTCRay ray = make_ray(from, (to - from) / distance, 1e-3, distance - 1e-3);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar >= 0;  // Embree marks an occluded ray with -inf
}

}  // namespace synth
