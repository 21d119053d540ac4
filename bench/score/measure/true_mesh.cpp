#include "score/measure/true_mesh.hpp"

#include <cstring>
#include <limits>
#include <stdexcept>

namespace score {
namespace {

constexpr double kOffSurfaceM =
    1e-3;  // more than float's error at building size, less than any thing in the scene

RTCRay ray_from(const Vec3& origin, const Vec3& direction, double far_m) {
  RTCRay ray;
  std::memset(&ray, 0, sizeof ray);
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = static_cast<float>(far_m);
  ray.mask = 0xffffffffu;
  return ray;
}

}  // namespace

TrueMesh::TrueMesh(const PlyContent& mesh) : device_(rtcNewDevice(nullptr)), scene_(nullptr) {
  if (!device_) throw std::runtime_error("Embree cannot start");
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Eigen::Vector3f), mesh.vertices.size());
  void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), mesh.triangles.size());
  if ((!vertices && !mesh.vertices.empty()) || (!corners && !mesh.triangles.empty())) throw std::bad_alloc();
  if (!mesh.vertices.empty())
    std::memcpy(vertices, mesh.vertices.data(), sizeof(Eigen::Vector3f) * mesh.vertices.size());
  if (!mesh.triangles.empty())
    std::memcpy(corners, mesh.triangles.data(), 3 * sizeof(std::uint32_t) * mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

TrueMesh::~TrueMesh() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

std::optional<TrueMesh::Hit> TrueMesh::first_hit(const Vec3& origin, const Vec3& direction) const {
  RTCRayHit query;
  query.ray = ray_from(origin, direction, std::numeric_limits<double>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  Vec3 normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  normal.normalize();
  if (normal.dot(direction) > 0) normal = -normal;
  return Hit{origin + static_cast<double>(query.ray.tfar) * direction, normal};
}

bool TrueMesh::sees(const Camera& camera, const Hit& surface) const {
  const Vec3 towards = camera.eye - surface.point;
  if (surface.normal.dot(towards) <= 0 || !camera.pixel_of(surface.point)) return false;
  const Vec3 start = surface.point + kOffSurfaceM * surface.normal;
  const double distance = (camera.eye - start).norm();
  RTCRay ray = ray_from(start, (camera.eye - start) / distance, distance - kOffSurfaceM);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar >= 0;  // Embree sets it to -infinity when something is hit
}

}  // namespace score
