#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_resample.h"

namespace hybrid::testing {

struct ResampleCase {
  static constexpr const char* kName = "resample";
  struct Input {
    ResampleParams params;
    std::vector<std::uint32_t> begin;
    std::vector<float> position;
    std::vector<std::array<float, 4>> sample;
    std::vector<std::array<float, 2>> ray_row, ray_col;
    std::size_t nodes() const { return std::size_t{params.rows} * params.cols; }
  };
  struct Output {
    std::vector<float> range, x, y, z;
    std::vector<std::uint8_t> mask;
    std::vector<std::uint32_t> pick;
  };

  // Columns of at most 40 samples from a random start over 48 rows: jitter, one in ten missing, one in twenty
  // twice, a wall at 4 m with posts 1 m in front of it and 2 mm of noise.
  static Input make(std::size_t size, std::uint32_t seed) {
    const float step = 0.01f;
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> uniform;
    Input input{{0, 48, 0, step, 3.0f, 0.02f, 0.25f, 1.5f}, {0}, {}, {}, {}, {}};
    while (input.sample.size() < size) {
      const std::size_t column_end = std::min(size, input.sample.size() + 40);
      const float azimuth = 0.01f * static_cast<float>(input.begin.size()), start = 4 * uniform(random);
      std::vector<float> positions;
      for (int k = 0; input.sample.size() + positions.size() < column_end; ++k) {
        const float chance = uniform(random);
        if (chance < 0.1f) continue;
        positions.push_back(start + static_cast<float>(k) + 0.1f * normal(random));
        if (chance > 0.95f && input.sample.size() + positions.size() < column_end)
          positions.push_back(positions.back() + 0.2f * uniform(random));
      }
      std::sort(positions.begin(), positions.end());
      for (const float position : positions) {
        const float elevation = 0.24f - step * position;
        const bool post = std::fmod(position, 16.0f) < 5.0f;
        const float range = (post ? 3.0f : 4.0f) / std::cos(elevation) + 0.002f * normal(random);
        input.position.push_back(position);
        input.sample.push_back({range * std::cos(elevation) * std::cos(azimuth),
                                range * std::cos(elevation) * std::sin(azimuth), range * std::sin(elevation),
                                range});
      }
      input.begin.push_back(static_cast<std::uint32_t>(input.sample.size()));
      input.ray_col.push_back({std::cos(azimuth), std::sin(azimuth)});
    }
    input.params.cols = static_cast<std::uint32_t>(input.ray_col.size());
    for (int row = 0; row < 48; ++row) {
      const float elevation = 0.24f - step * static_cast<float>(row);
      input.ray_row.push_back({std::cos(elevation), std::sin(elevation)});
    }
    return input;
  }

  static Output run(device::Queue& queue, const Input& input) {
    const auto begin = queue.array(input.begin);
    const auto position = queue.array(input.position);
    const auto sample = queue.array(input.sample);
    const auto ray_row = queue.array(input.ray_row), ray_col = queue.array(input.ray_col);
    const std::size_t n = input.nodes();
    auto range = queue.array<float>(n), x = queue.array<float>(n), y = queue.array<float>(n),
         z = queue.array<float>(n);
    auto mask = queue.array<std::uint8_t>(n);
    auto pick = queue.array<std::uint32_t>(n);
    queue.launch(kName, queue.kernel(kName),
                 device::grid(input.params.cols, (input.params.rows + RESAMPLE_STRIP - 1) / RESAMPLE_STRIP),
                 input.params, begin, position, sample, ray_row, ray_col, range, x, y, z, mask, pick);
    return {queue.read(range), queue.read(x),    queue.read(y),
            queue.read(z),     queue.read(mask), queue.read(pick)};
  }
  static Output reference(const Input& input);  // reference/resample.cpp

  static double items(const Input& input) { return static_cast<double>(input.nodes()); }
  static double bytes(const Input& input) {
    return 21.0 * items(input) + 24.0 * static_cast<double>(input.sample.size());
  }
  static double flops(const Input& input) { return 10.0 * items(input); }

  // Interpolated points: one product of three factors and a range from two, each rounded once.
  static constexpr double kRelativeTolerance = 1e-6;
  // Whether a gap is a depth jump may tip over where the two sides agree to rounding.
  static constexpr double kTippedShare = 1e-4;
};

}  // namespace hybrid::testing
