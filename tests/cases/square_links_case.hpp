#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_square_links.h"
#include "shared/records.h"

namespace hybrid::testing {

// Squares on a bumpy wall with steps and creases near every limit.
struct SquareLinksCase {
  static constexpr const char* kName = "square_links";
  struct Input {
    SquareLinkParams params;
    std::vector<SquareRecord> squares;
  };
  using Output = std::vector<float>;
  struct Expected {
    std::vector<double> links;
    // Relative distance of the nearest test from its limit. Below kMargin float may decide otherwise:
    // positions of 5 m have 5e-7 m of rounding, the tightest offset limit is 4 mm.
    std::vector<double> margin;
  };
  static constexpr double kMargin = 1e-3, kTolerance = 1e-3;

  static Input make(std::size_t size, std::uint32_t seed) {
    Input input{};
    const auto cols = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const auto rows = cols ? static_cast<std::uint32_t>((size + cols - 1) / cols) : 0u;
    const float step = 0.02f;
    input.params = {rows, cols, 1u, 2 * step, 2 * step, 0.05f, 0.002f, 3, 0.052f, 3, {}};
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, 1);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (std::uint32_t i = 0; i < rows * cols; ++i) {
      const float azimuth = step * static_cast<float>(i % cols),
                  elevation = 0.5f - step * static_cast<float>(i / cols);
      const float range = 5 + 0.004f * noise(random) + (uniform(random) < 0.1f ? 0.3f : 0.0f);
      const float ray[3] = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation)};
      SquareRecord square{};
      float normal[3], length = 0;
      for (int k = 0; k < 3; ++k) {
        square.centroid[k] = range * ray[k];
        normal[k] = -ray[k] + 0.02f * noise(random);
        length += normal[k] * normal[k];
      }
      for (int k = 0; k < 3; ++k) square.normal[k] = normal[k] / std::sqrt(length);
      square.sigma_normal = 0.02f * uniform(random);
      square.inliers = square.valid = 25;
      square.state = uniform(random) < 0.9f ? SQUARE_PLANAR : SQUARE_NON_PLANAR;
      input.squares.push_back(square);
    }
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto squares = queue.array(input.squares);
    auto links = queue.array<float>(2 * input.squares.size());
    queue.launch(kName, queue.kernel(kName), device::grid(input.squares.size()), input.params, squares,
                 links);
    return queue.read(links);
  }
  static Expected reference(const Input& input);  // reference/square_links.cpp

  static double items(const Input& input) { return static_cast<double>(input.squares.size()); }
  static double bytes(const Input& input) { return (sizeof(SquareRecord) + 8.0) * items(input); }
  static double flops(const Input& input) { return 120 * items(input); }
};

}  // namespace hybrid::testing
