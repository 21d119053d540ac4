#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "cases/ray_cast_case.hpp"
#include "geometry/camera.hpp"
#include "shared/params_blend_photos.h"
#include "stages/rendering/blend_bands.hpp"

namespace hybrid::testing {

// Mode and bands that the tests of the blending kernels go through.
inline constexpr std::pair<std::uint32_t, std::uint32_t> kBlendMixes[] = {
    {BLEND_NEAREST, 2}, {BLEND_LINEAR, 2}, {BLEND_BANDS, 2}, {BLEND_BANDS, 4}};

// Gains of the channels of every photograph of the case.
inline constexpr double kChannelGains[3] = {1.25, 1, 0.8};

// Small photographs of a cloud of triangles and spheres, blended into random surface points: three through a
// lens, the last of them with a mask, and two panoramas, one of them full.
struct BlendPhotosCase {
  static constexpr const char* kName = "blend_photos";
  struct Photo {
    Photograph photograph;
    std::vector<std::uint8_t> pixels;  // RGBA
    std::vector<float> low;            // 4 per pixel and Gaussian, multiples of 1/256: exact as half
    bool masked = false;               // alpha 0 is no photograph
    CameraRecord record() const {
      CameraRecord camera = stages::camera_record(photograph, Vec3::Zero());
      if (masked) camera.flags |= CAMERA_HAS_MASK;
      return camera;
    }
    std::vector<std::uint16_t> low_halves() const {
      std::vector<std::uint16_t> halves;
      for (float value : low) halves.push_back(Eigen::half(value).x);
      return halves;
    }
  };
  struct Input {
    RayScene scene;
    std::vector<Photo> photos;
    std::vector<float> surface;  // SURFACE_PLANES planes; every 13th point is none (NaN)
    std::vector<float> linear;   // of an sRGB byte, per channel, times kChannelGains
    std::uint32_t cols = 0, rows = 0;
    std::array<float, 3> eye{};
    BlendMode mix{BLEND_BANDS, 2, {8, 4, 2}};
    float pixel_rad = 0.001f;
    float feather_px = 8, tolerance_m = 0.02f, face_tolerance_m = 0.001f;
    float least_facing = 0.1f, least_facing_sample = 0.2f;
    int vector_width = 0;  // 0 = the device's
    std::size_t count() const { return std::size_t{cols} * rows; }
    std::size_t planes() const { return stages::blend_planes(mix); }
  };
  struct Output {
    std::vector<float> sums;
    std::vector<std::uint32_t> seen;
    std::vector<std::int32_t> best;
  };

  static Input make(std::size_t size, std::uint32_t seed);  // reference/blend_photos.cpp
  static Output run(device::Queue& queue, const Input& input) {
    const auto bvh = stages::upload_bvh(queue, stages::build_bvh(input.scene.triangles, input.scene.spheres),
                                        input.scene.surfaces);
    const int width = input.vector_width ? input.vector_width : queue.vector_width();
    const auto surface = queue.array(input.surface), linear = queue.array(input.linear);
    const auto sums = queue.array(std::vector<float>(input.planes() * input.count(), 0.0f));
    const auto seen = queue.array(std::vector<std::uint32_t>(input.count(), 0));
    const auto best = queue.array(std::vector<std::int32_t>(input.count(), -1));
    for (std::size_t i = 0; i < input.photos.size(); ++i) {
      const Photo& photo = input.photos[i];
      const auto pixels = queue.array(photo.pixels);
      const auto low = queue.array(photo.low_halves());
      BlendPhotosParams params{};
      params.camera = photo.record();
      for (int k = 0; k < 3; ++k) params.eye[k] = input.eye[static_cast<std::size_t>(k)];
      params.pixel_rad = input.pixel_rad;
      params.cols = input.cols;
      params.rows = input.rows;
      params.mix = input.mix;
      params.photograph = static_cast<int>(i);
      params.feather_px = input.feather_px;
      params.tolerance_m = input.tolerance_m;
      params.face_tolerance_m = input.face_tolerance_m;
      params.root = bvh.root;
      params.least_facing = input.least_facing;
      params.least_facing_sample = input.least_facing_sample;
      queue.launch(kName, queue.kernel(kName, {{"VW", width}}),
                   stages::packet_grid(width, input.cols, input.rows), params, bvh.nodes, bvh.triangles,
                   bvh.spheres, surface, pixels, low, linear, sums, seen, best);
      queue.finish();
    }
    return {queue.read(sums), queue.read(seen), queue.read(best)};
  }
  static Output reference(const Input& input);  // reference/blend_photos.cpp

  // The weight 1 / (angle + 0.001) turns the float error of the angle, 1e-6, into 1e-3 of the weight where
  // the angle is near 0, and the power of 8 into 8e-3 of a high band's share; the position in the photograph,
  // good to 1e-4 px, moves a colour by 1e-4.
  static bool agrees(const Output& got, const Output& expected, std::size_t i) {
    const std::size_t count = got.seen.size();
    if (got.seen[i] != expected.seen[i] || got.best[i] != expected.best[i]) return false;
    const float weight = expected.sums[BLEND_SUM_WEIGHT * count + i];
    for (std::size_t plane = 0; plane < expected.sums.size() / count; ++plane) {
      const bool relative = (plane >= BLEND_BEST_R && plane <= BLEND_BEST_SHARE) || plane >= BLEND_PLANES;
      const float tolerance = relative ? 1e-2f : 2e-3f * (1 + weight);
      if (!(std::abs(got.sums[plane * count + i] - expected.sums[plane * count + i]) < tolerance))
        return false;
    }
    return true;
  }
  // Points at a photograph's border or a shadow's edge may be decided either way.
  static constexpr double kUndecided = 5e-4;

  static double items(const Input& input) { return static_cast<double>(input.count() * input.photos.size()); }
  static double bytes(const Input& input) { return 124.0 * items(input); }
  static double flops(const Input& input) { return 1000.0 * items(input); }
};

}  // namespace hybrid::testing
