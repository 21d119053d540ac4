#pragma once
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_label_samples.h"

namespace hybrid::testing {

// A tile that begins inside its image, and inside a square: samples on or near one of 12 planes, squares with
// 0 to 8 candidates.
struct LabelSamplesCase {
  static constexpr const char* kName = "label_samples";
  struct Input {
    LabelParams params;
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> candidates;
    std::vector<std::array<float, 4>> own_plane;
    std::vector<LabelPlane> planes;
  };
  using Output = std::vector<std::uint32_t>;
  struct Expected {
    std::vector<std::uint32_t> labels;
    // How far the decision is from turning over, m. Below kMargin float may decide otherwise: products of 6 m
    // have 5e-7 m of rounding each, divided by a cosine of at least 0.05.
    std::vector<double> margin;
  };
  static constexpr double kMargin = 5e-5;

  static Input make(std::size_t size, std::uint32_t seed) {
    Input input{};
    const auto cols = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const auto rows = cols ? static_cast<std::uint32_t>((size + cols - 1) / cols) : 0u;
    const std::uint32_t square = 5, first = 12;
    const std::uint32_t square_rows = (first + rows + square - 1) / square;
    const std::uint32_t square_cols = (first + cols + square - 1) / square;
    input.params = {first, first, rows, cols, square, square_cols, 0.007f, 0.005f, 0.05f, {}};
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, 1);
    std::uniform_real_distribution<float> uniform(0, 1);
    const auto below = [&](std::uint32_t count) { return static_cast<std::uint32_t>(random() % count); };
    for (std::uint32_t i = 0; i < 12; ++i) {
      LabelPlane plane{};
      float length = 0;
      for (float& n : plane.normal) {
        n = noise(random);
        length += n * n;
      }
      for (float& n : plane.normal) n /= std::sqrt(length);
      plane.offset = -1 - 3 * uniform(random);
      plane.label = i % 4 == 3 ? 0 : i + 1;
      input.planes.push_back(plane);
    }
    // Mostly one candidate, as inside walls.
    for (std::uint32_t i = 0; i < square_rows * square_cols; ++i) {
      const std::uint32_t count = uniform(random) < 0.8f ? 1 : below(LABEL_CANDIDATES + 1);
      for (std::uint32_t k = 0; k < LABEL_CANDIDATES; ++k)
        input.candidates.push_back(k < count ? 1 + below(12) : 0);
      const LabelPlane& own = input.planes[below(12)];
      input.own_plane.push_back({0, 0, 0, 0});
      if (uniform(random) < 0.1f)
        input.own_plane.back() = {own.normal[0], own.normal[1], own.normal[2], own.offset + 0.002f};
    }
    for (std::uint32_t i = 0; i < rows * cols; ++i) {
      const std::uint32_t at = (first + i / cols) / square * square_cols + (first + i % cols) / square;
      const std::uint32_t near = std::max(input.candidates[at * LABEL_CANDIDATES + below(2)], 1u) - 1;
      const LabelPlane& plane = input.planes[near];
      float p[3], along = 0;
      for (int k = 0; k < 3; ++k) {
        p[k] = 3 * noise(random);
        along += p[k] * plane.normal[k];
      }
      for (int k = 0; k < 3; ++k)
        p[k] += (plane.offset - along + 0.006f * noise(random)) * plane.normal[k] +
                (uniform(random) < 0.05f ? NAN : 0.0f);
      input.x.push_back(p[0]);
      input.y.push_back(p[1]);
      input.z.push_back(p[2]);
    }
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto x = queue.array(input.x), y = queue.array(input.y), z = queue.array(input.z);
    const auto candidates = queue.array(input.candidates);
    const auto own_plane = queue.array(input.own_plane);
    const auto planes = queue.array(input.planes);
    auto labels = queue.array<std::uint32_t>(input.x.size());
    queue.launch(kName, queue.kernel(kName),
                 device::grid(LABEL_SQUARES_ACROSS(input.params), input.params.rows), input.params, x, y, z,
                 candidates, own_plane, planes, labels);
    return queue.read(labels);
  }
  static Expected reference(const Input& input);  // reference/label_samples.cpp

  static double items(const Input& input) { return static_cast<double>(input.x.size()); }
  static double bytes(const Input& input) { return 16 * items(input); }
  static double flops(const Input& input) { return 25 * items(input); }
};

}  // namespace hybrid::testing
