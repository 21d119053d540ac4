#pragma once
#include "cases/blend_photos_case.hpp"
#include "shared/params_rank_photos.h"

namespace hybrid::testing {

// The photographs and points of BlendPhotosCase, ranked instead of blended.
struct RankPhotosCase {
  static constexpr const char* kName = "rank_photos";
  struct Input {
    BlendPhotosCase::Input blend;
    std::uint32_t kept = 3;
    float resolution_cost = 0.05f, field_of_view_cost = 0.1f, pixel_ratio = 1.5f;
  };
  struct Output {
    std::vector<float> penalty;       // kept planes
    std::vector<std::int32_t> photo;  // kept planes
    std::vector<std::uint32_t> seen;
  };

  // Twice the photographs of BlendPhotosCase, from places a little apart.
  static Input make(std::size_t size, std::uint32_t seed);  // reference/rank_photos.cpp
  static Output run(device::Queue& queue, const Input& input) {
    const auto& blend = input.blend;
    const auto bvh = stages::upload_bvh(queue, stages::build_bvh(blend.scene.triangles, blend.scene.spheres),
                                        blend.scene.surfaces);
    const int width = blend.vector_width ? blend.vector_width : queue.vector_width();
    const auto surface = queue.array(blend.surface);
    const std::size_t ranks = input.kept * blend.count();
    const auto penalty = queue.array(std::vector<float>(ranks, std::numeric_limits<float>::infinity()));
    const auto photo = queue.array(std::vector<std::int32_t>(ranks, -1));
    const auto seen = queue.array(std::vector<std::uint32_t>(blend.count(), 0));
    for (std::size_t i = 0; i < blend.photos.size(); ++i) {
      RankPhotosParams params{};
      params.camera = blend.photos[i].record();
      const auto pixels = queue.array(blend.photos[i].pixels);
      for (int k = 0; k < 3; ++k) params.eye[k] = blend.eye[static_cast<std::size_t>(k)];
      params.pixel_ratio = input.pixel_ratio;
      params.cols = blend.cols;
      params.rows = blend.rows;
      params.kept = input.kept;
      params.photograph = static_cast<int>(i);
      params.feather_px = blend.feather_px;
      params.tolerance_m = blend.tolerance_m;
      params.face_tolerance_m = blend.face_tolerance_m;
      params.root = bvh.root;
      params.least_facing = blend.least_facing;
      params.least_facing_sample = blend.least_facing_sample;
      params.resolution_cost = input.resolution_cost;
      params.field_of_view_cost = input.field_of_view_cost;
      queue.launch(kName, queue.kernel(kName, {{"VW", width}}),
                   stages::packet_grid(width, blend.cols, blend.rows), params, bvh.nodes, bvh.triangles,
                   bvh.spheres, surface, pixels, penalty, photo, seen);
      queue.finish();
    }
    return {queue.read(penalty), queue.read(photo), queue.read(seen)};
  }
  static Output reference(const Input& input);  // reference/rank_photos.cpp

  // Angles are good to 1e-6, ratios of distances and cosines of 0.05 and more to 1e-5.
  static constexpr float kTolerance = 2e-5f;
  // Points at a photograph's border, at a shadow's edge or with two penalties alike may be decided either
  // way.
  static constexpr double kUndecided = 1e-3;
  static bool agrees(const Output& got, const Output& expected, std::size_t i) {
    const std::size_t count = got.seen.size();
    if (got.seen[i] != expected.seen[i]) return false;
    for (std::size_t at = i; at < got.photo.size(); at += count) {
      if (got.photo[at] != expected.photo[at]) return false;
      if (got.photo[at] >= 0 && !(std::abs(got.penalty[at] - expected.penalty[at]) < kTolerance))
        return false;
    }
    return true;
  }

  static double items(const Input& input) { return BlendPhotosCase::items(input.blend); }
  static double bytes(const Input& input) { return (36.0 + 8 * input.kept) * items(input); }
  static double flops(const Input& input) { return 1000.0 * items(input); }
};

}  // namespace hybrid::testing
