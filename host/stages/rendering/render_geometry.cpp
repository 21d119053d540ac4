#include "stages/rendering/render_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/free_memory.hpp"
#include "stages/rendering/bvh_join.hpp"

namespace hybrid::stages {
namespace {

void store(const Vec3& point, float (&to)[3]) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(point[k]);
}

Vec3 centre_of(const Splat& splat) {
  return {splat.centre_m[0], splat.centre_m[1], splat.centre_m[2]};
}

TriangleRecord triangle_record(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t id,
                               float radius_m = 0) {
  TriangleRecord record{};
  store(a, record.a);
  store(b, record.b);
  store(c, record.c);
  record.id = id;
  record.radius = radius_m;
  return record;
}

void append_triangles(const PolygonModel& model, const Vec3& origin, std::uint32_t first_id, float radius_m,
                      std::vector<TriangleRecord>& records) {
  for (const Triangle& t : triangulate(model))
    records.push_back(triangle_record(model.vertices[t.vertices[0]] - origin,
                                      model.vertices[t.vertices[1]] - origin,
                                      model.vertices[t.vertices[2]] - origin, first_id + t.face, radius_m));
}

Bvh curtain_tree(const std::vector<Curtain>& curtains, const Vec3& origin) {
  std::vector<TriangleRecord> records;
  for (const Curtain& curtain : curtains) {
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = curtain[k] - origin;
    for (const std::size_t k : {1, 2})
      records.push_back(triangle_record(corners[0], corners[k], corners[k + 1], 0));
  }
  return build_bvh(records, {});
}

RayCastParams cast_params(const DeviceBvh& geometry, const CameraRecord& camera, double tolerance_m) {
  RayCastParams params{};
  params.camera = camera;
  params.offset_x = params.offset_y = 0.5f;
  params.tolerance_m = static_cast<float>(tolerance_m);
  params.root = geometry.root;
  params.use_camera = 1;
  return params;
}

RayCastParams tile_params(const DeviceBvh& geometry, const CameraRecord& camera, const Tile& tile,
                          const std::array<float, 2>& offset, double tolerance_m, SurfaceTile& out) {
  RayCastParams params = cast_params(geometry, camera, tolerance_m);
  params.cols = out.cols = static_cast<std::uint32_t>(tile.cols);
  params.rows = out.rows = static_cast<std::uint32_t>(tile.rows);
  params.first_col = static_cast<std::uint32_t>(tile.col);
  params.first_row = static_cast<std::uint32_t>(tile.row);
  params.offset_x = offset[0];
  params.offset_y = offset[1];
  return params;
}

void launch(device::Queue& queue, const DeviceBvh& geometry, const RayCastParams& params,
            const device::Array<float>& distance, const device::Array<std::uint32_t>& id,
            const device::Array<float>& surface) {
  const auto no_directions = queue.array<float>(0);
  queue.launch("ray_cast", queue.kernel("ray_cast", {{"VW", queue.vector_width()}}),
               packet_grid(queue.vector_width(), params.cols, params.rows), params, geometry.nodes,
               geometry.triangles, geometry.spheres, geometry.surfaces, no_directions, distance, id, surface);
}

std::uint32_t lens_of(const Camera& camera) {
  if (camera.lens == Lens::fisheye) return CAMERA_FISHEYE;
  if (camera.lens == Lens::spherical) return CAMERA_SPHERICAL;
  if (camera.lens == Lens::cylindrical) return CAMERA_CYLINDRICAL;
  const bool rational = camera.k3 != 0 || camera.k4 != 0 || camera.k5 != 0 || camera.k6 != 0;
  return rational ? CAMERA_RATIONAL : CAMERA_POLYNOMIAL;
}

// A camera marker's length at most, as a share of the median distance of photographs to the next one and of
// its distance to the eye.
constexpr double kMarkerOfSpacing = 0.5, kMarkerOfDistance = 0.08;

// Median over the photographs of the distance to the nearest other one; infinite for one alone. Those at one
// place count as one.
double camera_spacing_m(const std::vector<Photograph>& photographs) {
  std::vector<double> nearest;
  for (const Photograph& photograph : photographs) {
    double least = std::numeric_limits<double>::infinity();
    for (const Photograph& other : photographs)
      if (const double d = (photograph.centre() - other.centre()).norm(); d > 1e-3)
        least = std::min(least, d);
    if (std::isfinite(least)) nearest.push_back(least);
  }
  if (nearest.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

}  // namespace

Eigen::AlignedBox3d scene_box(const RenderScene& scene) {
  Eigen::AlignedBox3d box;
  for (const PolygonModel* model : {&scene.proxy, &scene.contours})
    for (const Face& face : model->faces)
      for (std::uint32_t v : face.outer)
        if (v < model->vertices.size()) box.extend(model->vertices[v]);
  for (const Splat& splat : scene.splats)
    if (const Vec3 centre = centre_of(splat); centre.allFinite()) box.extend(centre);
  return box;
}

CameraRecord camera_record(const Photograph& photograph, const Vec3& origin) {
  const Camera& c = photograph.camera;
  const Mat3 rotation = photograph.cam_from_world.rotation.toRotationMatrix();
  CameraRecord record{};
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) record.rotation[3 * row + col] = static_cast<float>(rotation(row, col));
  store(photograph.cam_from_world * origin, record.translation);
  store(photograph.centre() - origin, record.centre);
  record.fx = static_cast<float>(c.fx), record.fy = static_cast<float>(c.fy);
  record.cx = static_cast<float>(c.cx), record.cy = static_cast<float>(c.cy);
  record.k1 = static_cast<float>(c.k1), record.k2 = static_cast<float>(c.k2);
  record.p1 = static_cast<float>(c.p1), record.p2 = static_cast<float>(c.p2);
  record.k3 = static_cast<float>(c.k3), record.k4 = static_cast<float>(c.k4);
  record.k5 = static_cast<float>(c.k5), record.k6 = static_cast<float>(c.k6);
  record.lens = lens_of(c);
  record.flags = (c.wraps() ? CAMERA_WRAPS : 0) | (c.reaches_zenith() ? CAMERA_ZENITH : 0) |
                 (c.reaches_nadir() ? CAMERA_NADIR : 0);
  record.max_radius2 = static_cast<float>(c.max_radius2());
  record.width = static_cast<std::uint32_t>(c.width);
  record.height = static_cast<std::uint32_t>(c.height);
  return record;
}

float pixel_angle_rad(const Camera& camera) {
  return static_cast<float>(1 / std::sqrt(std::abs(camera.fx * camera.fy)));
}

DeviceBvh make_render_geometry(device::Queue& queue, const RenderScene& scene, const std::string& show,
                               const Vec3& origin) {
  std::vector<TriangleRecord> triangles;
  std::vector<SphereRecord> spheres;
  std::vector<SphereSurface> surfaces;
  if (show != "scan") append_triangles(scene.proxy, origin, 1, 0, triangles);
  if (show != "proxy") {
    append_triangles(scene.contours, origin, kContourId, kContourRadius_m, triangles);
    spheres.reserve(scene.splats.size());
    surfaces.reserve(scene.splats.size());
    for (std::size_t i = 0; i < scene.splats.size(); ++i) {
      const Splat& splat = scene.splats[i];
      if (show == "both" && splat.on_face) continue;
      if (!centre_of(splat).allFinite() || !(splat.radius_m > 0) || !std::isfinite(splat.radius_m)) continue;
      SphereRecord sphere{};
      store(centre_of(splat) - origin, sphere.centre);
      sphere.radius = splat.radius_m;
      spheres.push_back(sphere);
      const auto& n = splat.normal;
      const bool known = std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
      const std::uint32_t id = kSplatId | static_cast<std::uint32_t>(i);
      surfaces.push_back(known ? SphereSurface{{n[0], n[1], n[2]}, id} : SphereSurface{{0, 0, 0}, id});
    }
  }
  const Bvh curtains = show == "proxy" ? Bvh() : curtain_tree(scene.curtains, origin);
  Bvh bvh = build_bvh(triangles, spheres, curtains);
  free_memory(spheres);
  const std::uint32_t curtain_root = append_tree(curtains, bvh);
  const std::uint32_t occluder_root = join_trees(bvh.root, curtain_root, bvh);
  DeviceBvh geometry = upload_bvh(queue, bvh, surfaces);
  geometry.curtain_root = curtain_root;
  geometry.occluder_root = occluder_root;
  return geometry;
}

DeviceBvh make_camera_markers(device::Queue& queue, const RenderScene& scene, const Vec3& origin,
                              const Vec3& eye, double most_m) {
  std::vector<TriangleRecord> triangles;
  const double usual_m = std::min(most_m, kMarkerOfSpacing * camera_spacing_m(scene.photographs));
  for (std::size_t i = 0; i < scene.photographs.size(); ++i) {
    const Photograph& photograph = scene.photographs[i];
    const Vec3 apex = photograph.centre() - origin;
    const double distance_m = (photograph.centre() - eye).norm();
    if (distance_m <= usual_m) continue;
    const double size_m = std::min(usual_m, kMarkerOfDistance * distance_m);
    const Camera& c = photograph.camera;
    const Pose world_from_cam = photograph.cam_from_world.inverse();
    const std::uint32_t id = kMarkerId | static_cast<std::uint32_t>(i);
    if (c.panorama()) {  // an octahedron: it sees to all sides
      for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
          for (const double z : {-0.5, 0.5})
            triangles.push_back(triangle_record(apex + size_m * world_from_cam.rotate({x, 0, 0}),
                                                apex + size_m * world_from_cam.rotate({0, y, 0}),
                                                apex + size_m * world_from_cam.rotate({0, 0, z}), id));
      continue;
    }
    std::array<Vec3, 4> base;
    const std::array<Vec2, 4> corners{Vec2(0, 0), Vec2(c.width, 0), Vec2(c.width, c.height),
                                      Vec2(0, c.height)};
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 in_cam((corners[k].x() - c.cx) / c.fx, (corners[k].y() - c.cy) / c.fy, 1);
      base[k] = apex + size_m * world_from_cam.rotate(in_cam);
    }
    for (std::size_t k = 0; k < 4; ++k)
      triangles.push_back(triangle_record(apex, base[k], base[(k + 1) % 4], id));
    triangles.push_back(triangle_record(base[0], base[1], base[2], id));
    triangles.push_back(triangle_record(base[0], base[2], base[3], id));
  }
  return upload_bvh(queue, build_bvh(triangles, {}), {});
}

SurfaceTile::SurfaceTile(device::Queue& queue, std::size_t capacity)
    : distance(queue.array<float>(capacity)),
      surface(queue.array<float>(SURFACE_PLANES * capacity)),
      id(queue.array<std::uint32_t>(capacity)) {}

void cast_tile(device::Queue& queue, const DeviceBvh& geometry, const CameraRecord& camera, const Tile& tile,
               const std::array<float, 2>& offset, double tolerance_m, SurfaceTile& out) {
  RayCastParams params = tile_params(geometry, camera, tile, offset, tolerance_m, out);
  params.want_surface = 1;
  launch(queue, geometry, params, out.distance, out.id, out.surface);
}

void cast_curtains(device::Queue& queue, const DeviceBvh& geometry, const CameraRecord& camera,
                   const Tile& tile, const std::array<float, 2>& offset, SurfaceTile& out) {
  RayCastParams params = tile_params(geometry, camera, tile, offset, 0, out);
  params.root = geometry.curtain_root;
  launch(queue, geometry, params, out.distance, out.id, out.surface);
}

DistanceMap cast_distances(device::Queue& queue, const DeviceBvh& geometry, const CameraRecord& camera,
                           double tolerance_m) {
  const std::size_t count = std::size_t{camera.width} * camera.height;
  DistanceMap map{queue.array<float>(count), queue.array<std::uint32_t>(count)};
  RayCastParams params = cast_params(geometry, camera, tolerance_m);
  params.cols = camera.width;
  params.rows = camera.height;
  launch(queue, geometry, params, map.distance, map.id, queue.array<float>(0));
  queue.finish();
  return map;
}

device::Grid packet_grid(int vector_width, std::size_t cols, std::size_t rows) {
  const auto width = static_cast<std::size_t>(vector_width);
  const std::size_t across = rows == 1 ? width : width >= 8 ? 4 : width == 4 ? 2 : 1;
  const std::size_t down = rows == 1 ? 1 : width / across;
  return device::uneven(device::grid((cols + across - 1) / across, (rows + down - 1) / down));
}

}  // namespace hybrid::stages
