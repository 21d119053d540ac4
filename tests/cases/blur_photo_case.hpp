#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_blur_photo.h"

namespace hybrid::testing {

// Both passes of the low band of one photograph: noise over surfaces at several distances, with sky above.
struct BlurPhotoCase {
  static constexpr const char* kName = "blur_photo";
  struct Input {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> pixels;  // RGBA
    std::vector<float> linear, weights, distance;
    std::vector<std::uint32_t> id;
    float tolerance_m = 0.02f, slope = 3, pixel_rad = 0.001f;
    std::uint32_t flags = 0;  // CAMERA_WRAPS, CAMERA_HAS_MASK
    double sigma_px = 4;
    std::uint32_t first = 0;  // pixels of `low` before the image
    std::size_t count() const { return std::size_t{width} * height; }
  };
  struct Output {
    std::vector<float> low;  // 4 per pixel
  };

  static Input make(std::size_t size, std::uint32_t seed, double sigma_px = 4);  // reference/blur_photo.cpp
  static Output run(device::Queue& queue, const Input& input) {
    const auto pixels = queue.array(input.pixels);
    const auto linear = queue.array(input.linear), weights = queue.array(input.weights);
    const auto distance = queue.array(input.distance);
    const auto id = queue.array(input.id);
    const auto rows = queue.array<std::uint16_t>(4 * input.count()),
               low = queue.array(std::vector<std::uint16_t>(4 * (input.first + input.count()), 0));
    BlurPhotoParams params{};
    params.width = input.width;
    params.height = input.height;
    params.radius = static_cast<std::uint32_t>(input.weights.size() - 1);
    params.tolerance_m = input.tolerance_m;
    params.slope = input.slope;
    params.pixel_rad = input.pixel_rad;
    const auto& kernel = queue.kernel(kName, {{"BLUR_FLAGS", static_cast<int>(input.flags)}});
    queue.launch(kName, kernel, device::grid(input.width, input.height), params, pixels, low, linear, weights,
                 distance, id, rows);
    params.vertical = 1;
    params.first = input.first;
    queue.launch(kName, kernel, device::grid(input.width, input.height), params, pixels, rows, linear,
                 weights, distance, id, low);
    Output out;
    const std::vector<std::uint16_t> halves = queue.read(low);
    for (std::uint16_t half : std::span(halves).subspan(4 * input.first))
      out.low.push_back(static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(half)));
    return out;
  }
  static Output reference(const Input& input);  // reference/blur_photo.cpp

  // Two roundings to half precision, 2^-11 each, of values up to 1.
  static constexpr float kTolerance = 1.1e-3f;

  static double items(const Input& input) { return static_cast<double>(input.count()); }
  static double taps(const Input& input) { return 2.0 * (2 * static_cast<double>(input.weights.size()) - 1); }
  static double bytes(const Input& input) { return 16.0 * taps(input) * items(input); }
  static double flops(const Input& input) { return 10.0 * taps(input) * items(input); }
};

}  // namespace hybrid::testing
