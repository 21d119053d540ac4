// Renderer's questions about single surface points, without colours: the photographs' visibility rule
// (kernels/rank_photos.cl) on points that no view hits.
#include <algorithm>

#include "core/parallel.hpp"
#include "shared/params_rank_photos.h"
#include "stages/rendering/photo_blend.hpp"
#include "stages/rendering/render_state.hpp"

namespace hybrid::stages {
namespace {

// The points on the device, in the layout of kernels/ray_cast.cl, as points of proxy faces.
device::Array<float> upload(device::Queue& queue, const std::vector<SurfacePoint>& points,
                            const Vec3& origin) {
  const std::size_t count = points.size();
  std::vector<float> planes(SURFACE_PLANES * count, 0.0f);
  parallel_for(
      count,
      [&](std::size_t i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const auto axis = static_cast<int>(k);
          planes[(SURFACE_X + k) * count + i] = static_cast<float>(points[i].position[axis] - origin[axis]);
          planes[(SURFACE_NORMAL_X + k) * count + i] = static_cast<float>(points[i].normal[axis]);
        }
      },
      1 << 13);
  return queue.array(planes);
}

// Adds 1 to `seen` where the camera sees the point.
void add_seen(RenderState& s, const CameraRecord& camera, int index,
              const device::Array<std::uint8_t>& pixels, const device::Array<float>& surface,
              std::size_t count, device::Array<std::uint32_t>& seen) {
  const DeviceBvh& occluders = s.geometry("both");
  RankPhotosParams params{};
  params.camera = camera;
  for (std::size_t k = 0; k < 3; ++k) params.eye[k] = camera.centre[k];
  params.pixel_ratio = 1;
  params.cols = static_cast<std::uint32_t>(count);
  params.rows = 1;
  params.photograph = index;
  params.tolerance_m = static_cast<float>(s.options.surface_tolerance_m);
  params.face_tolerance_m = kFaceTolerance_m;
  params.root = occluders.occluder_root;
  params.least_facing = params.least_facing_sample = least_facing(s.options);
  const int width = s.queue.vector_width();
  s.queue.launch("rank_photos", s.queue.kernel("rank_photos", {{"VW", width}}), packet_grid(width, count, 1),
                 params, occluders.nodes, occluders.triangles, occluders.spheres, surface, pixels,
                 s.queue.array<float>(0), s.queue.array<std::int32_t>(0), seen);
  s.queue.finish();  // the empty arrays live as long as this call
}

device::Array<std::uint32_t> zeros(device::Queue& queue, std::size_t count) {
  return queue.array(std::vector<std::uint32_t>(count, 0));
}

}  // namespace

std::vector<std::uint32_t> Renderer::count_seen(const std::vector<SurfacePoint>& points) {
  if (points.empty()) return {};
  RenderState& s = *state_;
  const auto surface = upload(s.queue, points, s.origin);
  auto seen = zeros(s.queue, points.size());
  const auto no_pixels = s.queue.array<std::uint8_t>(0);
  const DeviceBvh& everything = s.geometry("both");
  for (std::size_t i = 0; i < s.scene.photographs.size(); ++i)
    add_seen(s, s.store.camera(i), static_cast<int>(i),
             s.store.masked(i) ? s.store.get(i, everything).pixels : no_pixels, surface, points.size(), seen);
  return s.queue.read(seen);
}

std::vector<std::vector<std::uint32_t>> Renderer::seen_from(const std::vector<Photograph>& cameras,
                                                            const std::vector<SurfacePoint>& points) {
  std::vector<std::vector<std::uint32_t>> lists(cameras.size());
  if (points.empty()) return lists;
  RenderState& s = *state_;
  const auto surface = upload(s.queue, points, s.origin);
  const auto no_pixels = s.queue.array<std::uint8_t>(0);
  // Counted on from camera to camera, which spares an array each.
  auto seen = zeros(s.queue, points.size());
  std::vector<std::uint32_t> before(points.size(), 0), now(points.size());
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    add_seen(s, camera_record(cameras[c], s.origin), 0, no_pixels, surface, points.size(), seen);
    s.queue.read(seen, std::span<std::uint32_t>(now));
    for (std::uint32_t i = 0; i < now.size(); ++i)
      if (now[i] > before[i]) lists[c].push_back(i);
    before.swap(now);
  }
  return lists;
}

}  // namespace hybrid::stages
