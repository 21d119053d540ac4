#pragma once
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "cases/blend_photos_case.hpp"
#include "cases/room_scene.hpp"
#include "device/queue.hpp"
#include "shared/params_rank_photos.h"
#include "stages/rendering/blend_bands.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::testing {

// A 1080p view of a furnished room of 204 triangles, and as many splats as asked for on furniture and plants:
// what rays and photographs cost in practice. For bench/; the kernels' correctness has its own cases.
struct FurnishedRoom {
  static constexpr int kWidth = 1920, kHeight = 1080;
  stages::Bvh bvh;
  std::vector<SphereSurface> surfaces;
  CameraRecord view;

  // A bumpy ball of rings x 2 rings quadrilaterals, cut into triangles.
  static void add_ball(std::vector<TriangleRecord>& triangles, const Vec3& centre, double radius_m,
                       std::size_t rings) {
    const auto at = [&](std::size_t ring, std::size_t step) {
      const double up = M_PI * static_cast<double>(ring) / static_cast<double>(rings);
      const double round = M_PI * static_cast<double>(step) / static_cast<double>(rings);
      const double r = radius_m * (1 + 0.05 * std::sin(9 * up) * std::cos(7 * round));
      return Vec3(centre +
                  r * Vec3(std::sin(up) * std::cos(round), std::sin(up) * std::sin(round), std::cos(up)));
    };
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      TriangleRecord t{};
      for (int k = 0; k < 3; ++k) {
        t.a[k] = static_cast<float>(a[k]);
        t.b[k] = static_cast<float>(b[k]);
        t.c[k] = static_cast<float>(c[k]);
      }
      t.id = 1 + static_cast<std::uint32_t>(triangles.size());
      triangles.push_back(t);
    };
    for (std::size_t ring = 0; ring < rings; ++ring)
      for (std::size_t step = 0; step < 2 * rings; ++step) {
        if (ring > 0) add(at(ring, step), at(ring + 1, step), at(ring, step + 1));
        if (ring + 1 < rings) add(at(ring, step + 1), at(ring + 1, step), at(ring + 1, step + 1));
      }
  }

  // `rings`: of the ball on each of the 16 boxes; 0 = none. 39 make 95,060 triangles of it all.
  static FurnishedRoom make(std::size_t splats, std::uint32_t seed, std::size_t rings = 0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    RoomScene room;
    room.add_box({0, 0, 0}, {9, 7, 3.2}, true);
    std::vector<Vec3> lows, highs;
    for (int i = 0; i < 16; ++i) {
      const Vec3 low(0.4 + 8 * unit(random), 2 + 4.5 * unit(random), 0);
      lows.push_back(low);
      highs.push_back(low +
                      Vec3(0.2 + 0.5 * unit(random), 0.2 + 0.5 * unit(random), 0.4 + 1.4 * unit(random)));
      room.add_box(lows.back(), highs.back(), false);
    }
    for (std::size_t i = 0; rings > 0 && i < lows.size(); ++i)
      add_ball(room.triangles,
               {(lows[i].x() + highs[i].x()) / 2, (lows[i].y() + highs[i].y()) / 2, highs[i].z() + 0.3}, 0.3,
               rings);
    std::vector<SphereRecord> spheres;
    FurnishedRoom out;
    for (std::size_t i = 0; i < splats; ++i) {
      // On the sides of the boxes, and as balls of leaves on top of every other one.
      const std::size_t box = i % 16;
      Vec3 point =
          lows[box] + (highs[box] - lows[box]).cwiseProduct(Vec3(unit(random), unit(random), unit(random)));
      Vec3 normal = Vec3::Zero();
      if (box % 2) {
        const int axis = static_cast<int>(random() % 2);
        point[axis] = lows[box][axis];
        normal[axis] = -1;
      } else {
        point = Vec3((lows[box] + highs[box]) / 2) +
                Vec3(unit(random) - 0.5, unit(random) - 0.5, highs[box].z() + 0.6 * unit(random));
      }
      spheres.push_back(
          {{static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())},
           0.004f});
      out.surfaces.push_back(
          {{static_cast<float>(normal.x()), static_cast<float>(normal.y()), static_cast<float>(normal.z())},
           0x80000000u + static_cast<std::uint32_t>(i)});
    }
    out.bvh = stages::build_bvh(room.triangles, spheres);
    out.view = stages::camera_record(look_at({4.5, 0.3, 1.6}, {4.5, 6, 1}, {0, 0, 1}, 60, kWidth, kHeight),
                                     Vec3::Zero());
    return out;
  }

  stages::SurfaceTile cast(device::Queue& queue, const stages::DeviceBvh& geometry) const {
    stages::SurfaceTile tile(queue, static_cast<std::size_t>(kWidth) * kHeight);
    cast(queue, geometry, tile);
    return tile;
  }
  void cast(device::Queue& queue, const stages::DeviceBvh& geometry, stages::SurfaceTile& tile) const {
    stages::cast_tile(queue, geometry, view, {0, 0, kHeight, kWidth}, {0.5f, 0.5f}, 0.02, tile);
    queue.finish();
  }
};

struct RayCastViewCase {
  static constexpr const char* kName = "ray_cast";
  static FurnishedRoom make(std::size_t size, std::uint32_t seed) {
    return size == kMeshes ? FurnishedRoom::make(0, seed, kRings) : FurnishedRoom::make(size, seed);
  }
  static constexpr std::size_t kMeshes = 1;  // as a size: 95,060 triangles and no splat
  static constexpr std::size_t kRings = 39;
  static void run(device::Queue& queue, const FurnishedRoom& room) {
    room.cast(queue, stages::upload_bvh(queue, room.bvh, room.surfaces));
  }
  static double items(const FurnishedRoom&) { return 1.0 * FurnishedRoom::kWidth * FurnishedRoom::kHeight; }
  static double bytes(const FurnishedRoom& room) { return 36.0 * items(room); }
  static double flops(const FurnishedRoom& room) { return 1000.0 * items(room); }
};

// Eight 12 MP photographs that all look the view's way, in dual mode. Items: pixels, each from eight
// photographs.
struct BlendViewCase {
  static constexpr const char* kName = "blend_photos";
  static constexpr std::uint32_t kPhotoWidth = 4000, kPhotoHeight = 3000;
  struct Input {
    FurnishedRoom room;
    std::vector<CameraRecord> cameras;
    std::vector<std::uint8_t> pixels;  // the same for every photograph
    std::vector<std::uint16_t> low;
    BlendMode mix{BLEND_BANDS, 2, {8}};
  };
  static Input make(std::size_t size, std::uint32_t seed) {
    Input input;
    input.room = RayCastViewCase::make(size, seed);
    for (int i = 0; i < 8; ++i) {
      Photograph p =
          look_at({0.8 + i, 0.2, 1.5 + 0.1 * i}, {4.5, 6, 1}, {0, 0, 1}, 75, kPhotoWidth, kPhotoHeight);
      p.camera.k1 = -0.05;
      input.cameras.push_back(stages::camera_record(p, Vec3::Zero()));
    }
    std::mt19937 random(seed);
    input.pixels.resize(std::size_t{4} * kPhotoWidth * kPhotoHeight);
    for (auto& value : input.pixels) value = static_cast<std::uint8_t>(random());
    input.low.resize(input.pixels.size(), 0x3800);  // one half
    return input;
  }
  // Arrays of one run on the device, the sums at their start.
  struct Arrays {
    Arrays(device::Queue& queue, const Input& input)
        : bvh(stages::upload_bvh(queue, input.room.bvh, input.room.surfaces)),
          tile(input.room.cast(queue, bvh)),
          pixels(queue.array(input.pixels)),
          low(queue.array(input.low)),
          linear(queue.array(std::vector<float>(3 * 256, 0.5f))),
          sums(queue.array(std::vector<float>(stages::blend_planes(input.mix) * tile.count(), 0.0f))),
          seen(queue.array(std::vector<std::uint32_t>(tile.count(), 0))),
          best(queue.array(std::vector<std::int32_t>(tile.count(), -1))) {}
    stages::DeviceBvh bvh;
    stages::SurfaceTile tile;
    device::Array<std::uint8_t> pixels;
    device::Array<std::uint16_t> low;
    device::Array<float> linear, sums;
    device::Array<std::uint32_t> seen;
    device::Array<std::int32_t> best;
  };
  static void run(device::Queue& queue, const Input& input) {
    Arrays at(queue, input);
    blend(queue, input, at);
  }
  // Sets sums, seen and best back to their start.
  static void clear(device::Queue& queue, Arrays& at) {
    queue.write(at.sums, std::span<const float>(std::vector<float>(at.sums.count(), 0.0f)));
    queue.write(at.seen, std::span<const std::uint32_t>(std::vector<std::uint32_t>(at.seen.count(), 0)));
    queue.write(at.best, std::span<const std::int32_t>(std::vector<std::int32_t>(at.best.count(), -1)));
  }
  // All photographs, onto `at`.
  static void blend(device::Queue& queue, const Input& input, const Arrays& at) {
    const int width = queue.vector_width();
    const auto grid = stages::packet_grid(width, at.tile.cols, at.tile.rows);
    for (std::size_t i = 0; i < input.cameras.size(); ++i) {
      BlendPhotosParams params{};
      params.camera = input.cameras[i];
      for (int k = 0; k < 3; ++k) params.eye[k] = input.room.view.centre[k];
      params.pixel_rad = 0.001f;
      params.cols = at.tile.cols;
      params.rows = at.tile.rows;
      params.mix = input.mix;
      params.photograph = static_cast<int>(i);
      params.feather_px = 32;
      params.tolerance_m = 0.02f;
      params.face_tolerance_m = 0.001f;
      params.root = at.bvh.root;
      queue.launch(kName, queue.kernel(kName, {{"VW", width}}), grid, params, at.bvh.nodes, at.bvh.triangles,
                   at.bvh.spheres, at.tile.surface, at.pixels, at.low, at.linear, at.sums, at.seen, at.best);
    }
    queue.finish();
  }
  static double items(const Input&) { return 1.0 * FurnishedRoom::kWidth * FurnishedRoom::kHeight; }
  static double bytes(const Input& input) { return 8 * 124.0 * items(input); }
  static double flops(const Input& input) { return 8 * 1000.0 * items(input); }
};

// The same view in multi-band's default of four bands, each photograph with its three Gaussians.
struct MultiBandViewCase : BlendViewCase {
  static Input make(std::size_t size, std::uint32_t seed) {
    Input input = BlendViewCase::make(size, seed);
    input.mix = {BLEND_BANDS, 4, {4, 3, 2}};
    input.low.resize(3 * input.pixels.size(), 0x3800);
    return input;
  }
  static double bytes(const Input& input) { return 8 * 252.0 * items(input); }  // 64 more for two bands each
};

// The same view by weights of unstructured lumigraph rendering, k = 4: ranking, and blending what was ranked.
template <bool kBlending>
struct UlrViewCase {
  static constexpr const char* kName = kBlending ? "blend_ranked" : "rank_photos";
  static constexpr std::uint32_t kKept = 5;
  using Input = BlendViewCase::Input;
  static Input make(std::size_t size, std::uint32_t seed) { return BlendViewCase::make(size, seed); }
  struct Arrays : BlendViewCase::Arrays {
    Arrays(device::Queue& queue, const Input& input)
        : BlendViewCase::Arrays(queue, input),
          penalty(queue.array(std::vector<float>(kKept * tile.count(), INFINITY))),
          ranked(queue.array(std::vector<std::int32_t>(kKept * tile.count(), -1))) {}
    device::Array<float> penalty;
    device::Array<std::int32_t> ranked;
  };
  static void run(device::Queue& queue, const Input& input) {
    const Arrays at(queue, input);
    rank(queue, input, at);
    if (kBlending) blend(queue, input, at);
  }
  static void clear(device::Queue& queue, Arrays& at) {
    BlendViewCase::clear(queue, at);
    queue.write(at.penalty, std::span<const float>(std::vector<float>(at.penalty.count(), INFINITY)));
    queue.write(at.ranked, std::span<const std::int32_t>(std::vector<std::int32_t>(at.ranked.count(), -1)));
  }
  static void rank(device::Queue& queue, const Input& input, const Arrays& at) {
    const int width = queue.vector_width();
    const auto grid = stages::packet_grid(width, at.tile.cols, at.tile.rows);
    for (std::size_t i = 0; i < input.cameras.size(); ++i) {
      RankPhotosParams params{};
      params.camera = input.cameras[i];
      for (int k = 0; k < 3; ++k) params.eye[k] = input.room.view.centre[k];
      params.pixel_ratio = 0.4f;
      params.cols = at.tile.cols;
      params.rows = at.tile.rows;
      params.kept = kKept;
      params.photograph = static_cast<int>(i);
      params.feather_px = 32;
      params.tolerance_m = 0.02f;
      params.face_tolerance_m = 0.001f;
      params.root = at.bvh.root;
      params.resolution_cost = 0.05f;
      params.field_of_view_cost = 0.1f;
      queue.launch("rank_photos", queue.kernel("rank_photos", {{"VW", width}}), grid, params, at.bvh.nodes,
                   at.bvh.triangles, at.bvh.spheres, at.tile.surface, at.pixels, at.penalty, at.ranked,
                   at.seen);
    }
    queue.finish();
  }
  static void blend(device::Queue& queue, const Input& input, const Arrays& at) {
    const int width = queue.vector_width();
    const auto grid = stages::packet_grid(width, at.tile.cols, at.tile.rows);
    for (std::size_t i = 0; i < input.cameras.size(); ++i) {
      BlendRankedParams params{};
      params.camera = input.cameras[i];
      params.cols = at.tile.cols;
      params.rows = at.tile.rows;
      params.mix = input.mix;
      params.photograph = static_cast<int>(i);
      params.kept = kKept;
      params.feather_px = 32;
      params.pixel_rad = 0.001f;
      queue.launch("blend_ranked", queue.kernel("blend_ranked", {{"VW", width}}), grid, params,
                   at.tile.surface, at.penalty, at.ranked, at.pixels, at.low, at.linear, at.sums, at.best);
    }
    queue.finish();
  }
  static double items(const Input& input) { return BlendViewCase::items(input); }
  static double bytes(const Input& input) { return 8 * (kBlending ? 164.0 : 76.0) * items(input); }
  static double flops(const Input& input) { return 8 * (kBlending ? 150.0 : 1000.0) * items(input); }
};
using RankViewCase = UlrViewCase<false>;
using BlendRankedViewCase = UlrViewCase<true>;

}  // namespace hybrid::testing
