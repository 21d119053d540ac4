#pragma once
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_stray_samples.h"

namespace hybrid::testing {

// A near and a far wall with a ragged edge between them; mixed, lone, missing and labelled samples.
struct StraySamplesCase {
  static constexpr const char* kName = "stray_samples";
  struct Input {
    StraySamplesParams params;
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> label;
    int vector_width = 0;  // 0: the device's
  };
  using Output = std::vector<std::uint8_t>;
  // Per sample the set of answers that some threshold within kMargin of the given ones gives, as bits
  // 1 << STRAY_...: float may decide those either way. Points of 5 m round to 3e-7 m, a tolerance is
  // as tight as 0.24 mm across a grazing plane, and test planes carry the error up to four times as far.
  using Expected = std::vector<std::uint8_t>;
  static constexpr double kMargin = 5e-3;

  static Input make(std::size_t size, std::uint32_t seed) {
    Input input{};
    const auto cols = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const auto rows = cols ? static_cast<std::uint32_t>((size + cols - 1) / cols) : 0u;
    input.params = {rows, cols, 0.011f, 0.012f, 0.02f, 5, 3, 0.41f, 0.125f, 8, {}};
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, 0.002f);
    std::uniform_real_distribution<float> uniform(0, 1);
    const float step = 0.003f, nan = std::numeric_limits<float>::quiet_NaN();
    const std::uint32_t width = cols + 2 * STRAY_WINDOW, height = rows + 2 * STRAY_WINDOW;
    for (std::uint32_t r = 0; size > 0 && r < height; ++r)
      for (std::uint32_t c = 0; c < width; ++c) {
        const float azimuth = step * static_cast<float>(c), elevation = 0.3f - step * static_cast<float>(r);
        const int stripe = static_cast<int>((c + r / 3) % 16);
        float range = stripe < 8 ? 3.0f : 5.0f;
        if (stripe == 8) range += -2.0f * uniform(random);  // mixed
        if (stripe > 12) range += 0.1f * static_cast<float>(stripe - 12);
        if (uniform(random) < 0.02f) range *= 0.5f + uniform(random);
        range = uniform(random) < 0.03f ? nan : range + noise(random);
        input.x.push_back(range * std::cos(elevation) * std::cos(azimuth));
        input.y.push_back(range * std::cos(elevation) * std::sin(azimuth));
        input.z.push_back(range * std::sin(elevation));
      }
    for (std::uint32_t i = 0; i < rows * cols; ++i) input.label.push_back(random() % 5 == 0);
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto x = queue.array(input.x), y = queue.array(input.y), z = queue.array(input.z);
    const auto label = queue.array(input.label);
    auto stray = queue.array<std::uint8_t>(input.label.size());
    const int lanes = input.vector_width > 0 ? input.vector_width : queue.vector_width();
    const auto width = static_cast<std::size_t>(lanes);
    queue.launch(kName, queue.kernel(kName, {{"VW", lanes}}),
                 device::grid((input.params.cols + width - 1) / width, input.params.rows), input.params, x, y,
                 z, label, stray);
    return queue.read(stray);
  }
  static Expected reference(const Input& input);  // reference/stray_samples.cpp

  static double items(const Input& input) { return static_cast<double>(input.label.size()); }
  static double bytes(const Input& input) { return 17 * items(input); }
  static double flops(const Input& input) { return 1000 * items(input); }
};

}  // namespace hybrid::testing
