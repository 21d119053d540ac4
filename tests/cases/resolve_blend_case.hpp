#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_blend_photos.h"

namespace hybrid::testing {

struct ResolveBlendCase {
  static constexpr const char* kName = "resolve_blend";
  struct Input {
    std::vector<float> surface_x;  // every 5th NaN
    std::vector<float> sums;
    std::vector<std::uint32_t> seen;  // every 7th 0
    std::uint32_t mode = BLEND_BANDS, bands = 2;
  };
  struct Output {
    std::vector<float> colour;
  };

  static Input make(std::size_t size, std::uint32_t seed, std::uint32_t bands = 2) {
    Input input;
    input.bands = bands;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-0.5f, 2);
    input.sums.resize((BLEND_PLANES + BLEND_BAND_PLANES * (bands - 2)) * size);
    for (float& sum : input.sums) sum = value(random);
    for (std::size_t i = 0; i < size; ++i) {
      input.surface_x.push_back(i % 5 == 4 ? std::numeric_limits<float>::quiet_NaN() : 1.0f);
      input.seen.push_back(i % 7 == 6 ? 0 : 2);
      input.sums[BLEND_SUM_WEIGHT * size + i] = i % 7 == 6 ? 0.0f : 1.5f + value(random);
      input.sums[BLEND_BEST_SHARE * size + i] = i % 7 == 6 ? 0.0f : 1.5f + value(random);
      for (std::size_t plane = BLEND_PLANES + 3; plane < input.sums.size() / size; plane += BLEND_BAND_PLANES)
        input.sums[plane * size + i] = i % 7 == 6 ? 0.0f : 1.5f + value(random);
    }
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto surface_x = queue.array(input.surface_x), sums = queue.array(input.sums);
    const auto seen = queue.array(input.seen);
    const auto colour = queue.array<float>(3 * input.seen.size());
    const ResolveBlendParams params{static_cast<std::uint32_t>(input.seen.size()), input.mode, input.bands,
                                    0};
    queue.launch(kName, queue.kernel(kName), device::grid(input.seen.size()), params, surface_x, sums, seen,
                 colour);
    return {queue.read(colour)};
  }
  static Output reference(const Input& input);  // reference/resolve_blend.cpp

  // Two divisions and one addition of numbers up to 4: five roundings, and two for
  // each further band.
  static constexpr float kTolerance = 1e-6f;
  static constexpr float kTolerancePerBand = 1e-6f;

  static double items(const Input& input) { return static_cast<double>(input.seen.size()); }
  static double bytes(const Input& input) { return 56.0 * items(input); }
  static double flops(const Input& input) { return 10.0 * items(input); }
};

}  // namespace hybrid::testing
