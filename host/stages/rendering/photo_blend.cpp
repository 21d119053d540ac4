#include "stages/rendering/photo_blend.hpp"

#include <limits>
#include <set>
#include <span>

#include "shared/params_blend_photos.h"
#include "shared/params_rank_photos.h"

namespace hybrid::stages {
namespace {

// Photographs remembered per point: the k best and the one whose penalty ends them.
std::size_t kept_photographs(const RenderOptions& options) {
  return options.weights == "ulr" ? static_cast<std::size_t>(options.ulr_k) + 1 : 0;
}

template <typename T>
void fill(device::Queue& queue, device::Array<T>& array, std::size_t count, T value) {
  const std::vector<T> values(count, value);
  queue.write(array, std::span<const T>(values));
}

}  // namespace

PhotoBlend::PhotoBlend(device::Queue& queue, const RenderOptions& options, std::size_t capacity)
    : queue_(queue),
      options_(options),
      mode_(blend_mode(options)),
      kept_(kept_photographs(options)),
      sums_(queue.array<float>(blend_planes(mode_) * capacity)),
      colour_(queue.array<float>(3 * capacity)),
      penalty_(queue.array<float>(kept_ * capacity)),
      seen_(queue.array<std::uint32_t>(capacity)),
      best_(queue.array<std::int32_t>(capacity)),
      ranked_(queue.array<std::int32_t>(kept_ * capacity)),
      no_pixels_(queue.array<std::uint8_t>(0)) {}

void PhotoBlend::blend(PhotographStore& store, const DeviceBvh& occluders, const DeviceBvh& everything,
                       const SurfaceTile& tile, const PhotoBlendView& view,
                       const std::vector<std::size_t>& used, const std::vector<device::Array<float>>& light) {
  fill(queue_, sums_, blend_planes(mode_) * tile.count(), 0.0f);
  fill(queue_, seen_, tile.count(), std::uint32_t{0});
  fill(queue_, best_, tile.count(), std::int32_t{-1});
  if (kept_ > 0) {
    fill(queue_, penalty_, kept_ * tile.count(), std::numeric_limits<float>::infinity());
    fill(queue_, ranked_, kept_ * tile.count(), std::int32_t{-1});
    for (std::size_t index : used) rank(store, index, occluders, everything, tile, view);
  }
  for (std::size_t index : kept_ > 0 ? ranked_photographs(tile.count()) : used) {
    const PhotographStore::Entry& photograph = store.get(index, everything);
    if (kept_ > 0)
      add_ranked(index, photograph, tile, view, light[index]);
    else
      add(index, photograph, occluders, tile, view, light[index]);
  }
  const ResolveBlendParams resolve{static_cast<std::uint32_t>(tile.count()), mode_.mode, mode_.bands, 0};
  queue_.launch("resolve_blend", queue_.kernel("resolve_blend"), device::grid(tile.count()), resolve,
                tile.surface, sums_, seen_, colour_);
}

// Those that some point remembers: no other has to be on the device.
std::vector<std::size_t> PhotoBlend::ranked_photographs(std::size_t points) {
  std::vector<std::int32_t> ranked(kept_ * points);
  queue_.read(ranked_, std::span<std::int32_t>(ranked));
  std::set<std::int32_t> found;
  std::int32_t last = -1;
  for (const std::int32_t index : ranked)
    if (index != last && index >= 0) found.insert(last = index);
  return {found.begin(), found.end()};
}

void PhotoBlend::add(std::size_t index, const PhotographStore::Entry& photograph, const DeviceBvh& occluders,
                     const SurfaceTile& tile, const PhotoBlendView& view, const device::Array<float>& light) {
  BlendPhotosParams params{};
  params.camera = photograph.camera;
  for (std::size_t k = 0; k < 3; ++k) params.eye[k] = view.eye[k];
  params.pixel_rad = view.pixel_rad;
  params.cols = tile.cols;
  params.rows = tile.rows;
  params.mix = mode_;
  params.photograph = static_cast<int>(index);
  params.feather_px = photograph.pixel_scale * static_cast<float>(options_.feather_px);
  params.tolerance_m = static_cast<float>(options_.surface_tolerance_m);
  params.face_tolerance_m = kFaceTolerance_m;
  params.root = occluders.occluder_root;
  params.least_facing = least_facing(options_);
  params.least_facing_sample = least_facing_sample(options_);
  launch("blend_photos", tile, params, occluders.nodes, occluders.triangles, occluders.spheres, tile.surface,
         photograph.pixels, photograph.low, light, sums_, seen_, best_);
}

void PhotoBlend::rank(PhotographStore& store, std::size_t index, const DeviceBvh& occluders,
                      const DeviceBvh& everything, const SurfaceTile& tile, const PhotoBlendView& view) {
  RankPhotosParams params{};
  params.camera = store.camera(index);
  for (std::size_t k = 0; k < 3; ++k) params.eye[k] = view.eye[k];
  params.pixel_ratio = store.pixel_rad(index) / view.pixel_rad;
  params.cols = tile.cols;
  params.rows = tile.rows;
  params.kept = static_cast<std::uint32_t>(kept_);
  params.photograph = static_cast<int>(index);
  params.feather_px = static_cast<float>(options_.feather_px);
  params.tolerance_m = static_cast<float>(options_.surface_tolerance_m);
  params.face_tolerance_m = kFaceTolerance_m;
  params.root = occluders.occluder_root;
  params.least_facing = least_facing(options_);
  params.least_facing_sample = least_facing_sample(options_);
  params.resolution_cost = static_cast<float>(options_.ulr_resolution);
  params.field_of_view_cost = static_cast<float>(options_.ulr_field_of_view);
  // Only a mask makes the pixels matter here.
  const auto& pixels = store.masked(index) ? store.get(index, everything).pixels : no_pixels_;
  launch("rank_photos", tile, params, occluders.nodes, occluders.triangles, occluders.spheres, tile.surface,
         pixels, penalty_, ranked_, seen_);
}

void PhotoBlend::add_ranked(std::size_t index, const PhotographStore::Entry& photograph,
                            const SurfaceTile& tile, const PhotoBlendView& view,
                            const device::Array<float>& light) {
  BlendRankedParams params{};
  params.camera = photograph.camera;
  params.cols = tile.cols;
  params.rows = tile.rows;
  params.mix = mode_;
  params.photograph = static_cast<int>(index);
  params.kept = static_cast<std::uint32_t>(kept_);
  params.feather_px = photograph.pixel_scale * static_cast<float>(options_.feather_px);
  params.pixel_rad = view.pixel_rad;
  launch("blend_ranked", tile, params, tile.surface, penalty_, ranked_, photograph.pixels, photograph.low,
         light, sums_, best_);
}

template <typename... Args>
void PhotoBlend::launch(const char* name, const SurfaceTile& tile, const Args&... args) {
  const int width = queue_.vector_width();
  queue_.launch(name, queue_.kernel(name, {{"VW", width}}), packet_grid(width, tile.cols, tile.rows),
                args...);
}

}  // namespace hybrid::stages
