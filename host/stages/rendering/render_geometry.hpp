#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "device/queue.hpp"
#include "geometry/camera.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_ray_cast.h"
#include "stages/rendering/bvh.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::stages {

// Bit of a hit's id that says splat; below it the splat's index.
inline constexpr std::uint32_t kSplatId = 0x80000000u;
// Bit of a hit's id that says photograph marker (ViewRequest::cameras); below it the photograph's index.
inline constexpr std::uint32_t kMarkerId = 0x40000000u;

// Bit of a hit's id that says contour polygon; below it the face's index in RenderScene::contours.
inline constexpr std::uint32_t kContourId = 0x20000000u;

// What ray_cast reports as the radius of a contour polygon: too small for any distance, but not the 0 of a
// proxy face. Two scans' contours of one surface lie within their noise, so they must not shadow each other.
inline constexpr float kContourRadius_m = SURFACE_POLYGON_RADIUS;

// Bounding box of faces, contours and splats; empty for an empty scene. Its centre is the local origin on the
// device.
Eigen::AlignedBox3d scene_box(const RenderScene& scene);

// The photograph's or view's camera relative to the local origin.
CameraRecord camera_record(const Photograph& photograph, const Vec3& origin);

// Angle of one pixel at the image's centre.
float pixel_angle_rad(const Camera& camera);

// Primary and shadow geometry of what is shown ("proxy" | "scan" | "both"); contours and splats are of the
// scans, and so are curtains, which hide and are no surface: only occluder_root and curtain_root lead to
// them. Splats that are not finite or have no radius are left out, and beside the proxy those on its faces.
DeviceBvh make_render_geometry(device::Queue& queue, const RenderScene& scene, const std::string& show,
                               const Vec3& origin);

// Pyramids at the photographs' centres, opening along their views; `most_m` long, less where photographs
// stand close to each other and near `eye`, so that they hide little of what it looks at; none for
// photographs so near to it that it would look out of their marker.
DeviceBvh make_camera_markers(device::Queue& queue, const RenderScene& scene, const Vec3& origin,
                              const Vec3& eye, double most_m);

// What the rays of one tile hit, on the device; for the layout see kernels/ray_cast.cl.
struct SurfaceTile {
  explicit SurfaceTile(device::Queue& queue, std::size_t capacity);
  std::uint32_t cols = 0, rows = 0;
  std::size_t count() const { return std::size_t{cols} * rows; }
  device::Array<float> distance, surface;
  device::Array<std::uint32_t> id;
};

// Casts the camera's rays through the pixels of `tile` at `offset` in each pixel. Kernel: ray_cast.
void cast_tile(device::Queue& queue, const DeviceBvh& geometry, const CameraRecord& camera, const Tile& tile,
               const std::array<float, 2>& offset, double tolerance_m, SurfaceTile& out);

// Distances to the curtains alone.
void cast_curtains(device::Queue& queue, const DeviceBvh& geometry, const CameraRecord& camera,
                   const Tile& tile, const std::array<float, 2>& offset, SurfaceTile& out);

// Distance and id of every pixel of a camera. Kernel: ray_cast.
struct DistanceMap {
  device::Array<float> distance;
  device::Array<std::uint32_t> id;
};
DistanceMap cast_distances(device::Queue& queue, const DeviceBvh& geometry, const CameraRecord& camera,
                           double tolerance_m);

// Work-items of a kernel on packets of `vector_width` lanes (lib/packet.h) over cols x rows.
device::Grid packet_grid(int vector_width, std::size_t cols, std::size_t rows);

}  // namespace hybrid::stages
