#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_window_planes.h"

namespace hybrid::testing {

// A tile with a halo on a wall of facets 16 samples square, each turned and shifted its own way, whose noise
// is now below and now above what the parameters expect; holes and taken samples everywhere.
struct WindowPlanesCase {
  static constexpr const char* kName = "window_planes";
  struct Input {
    WindowPlanesParams params;
    std::vector<float> x, y, z;
    std::vector<std::uint8_t> free;
    int vector_width = 0;  // 0: the device's
  };
  using Output = std::vector<std::uint8_t>;
  struct Expected {
    std::vector<std::uint8_t> shapes;
    // Relative distance from its limit of the nearest test that decided. Below kMargin float may decide
    // otherwise: coordinates of 5 m have 2.4e-7 m of rounding, residuals of 2 mm are known to 3e-4, and chi2
    // is their square.
    std::vector<double> margin;
  };
  static constexpr double kMargin = 3e-3;

  static Input make(std::size_t size, std::uint32_t seed) {
    Input input{};
    const auto cols = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const auto rows = cols ? static_cast<std::uint32_t>((size + cols - 1) / cols) : 0u;
    const std::uint32_t halo_rows = rows + 5, halo_cols = cols + WINDOW_REACH - 1;  // the image ends below
    input.params = {rows,
                    cols,
                    rows ? halo_rows : 0,
                    rows ? halo_cols : 0,
                    4.0f,
                    0.7f,
                    0.1f,
                    0,
                    {0.001f, 0.0002f, 0.0001f, 0.00005f}};
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, 1);
    std::uniform_real_distribution<float> uniform(0, 1);
    const std::uint32_t facets = input.params.halo_cols / 16 + 1;
    std::vector<float> slope_a, slope_b, shift, sigma;
    for (std::uint32_t i = 0; i < (input.params.halo_rows / 16 + 1) * facets; ++i) {
      // Up to 0.8 each: within 0.52 rad of the axis the wall then stays in front of the scanner.
      slope_a.push_back(std::clamp(0.6f * noise(random), -0.8f, 0.8f));
      slope_b.push_back(std::clamp(0.6f * noise(random), -0.8f, 0.8f));
      shift.push_back(0.1f * noise(random));
      sigma.push_back(0.0005f + 0.003f * uniform(random));
    }
    for (std::uint32_t row = 0; row < input.params.halo_rows; ++row)
      for (std::uint32_t col = 0; col < input.params.halo_cols; ++col) {
        const std::uint32_t facet = row / 16 * facets + col / 16;
        // The angles stay small: the wall is 4 m away, a sample every 1.4 cm.
        const float a = 0.0035f * (static_cast<float>(col % 300) - 150),
                    b = 0.0035f * (static_cast<float>(row % 300) - 150);
        const float length = std::sqrt(1 + a * a + b * b);
        const float range = (4 + shift[facet]) * length / (1 + slope_a[facet] * a + slope_b[facet] * b) +
                            sigma[facet] * noise(random);
        const bool hole = uniform(random) < 0.05f;
        input.x.push_back(hole ? NAN : range / length);
        input.y.push_back(hole ? NAN : range / length * a);
        input.z.push_back(hole ? NAN : range / length * b);
        input.free.push_back(!hole && (facet % 3 != 0 || uniform(random) < 0.2f));
      }
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto x = queue.array(input.x), y = queue.array(input.y), z = queue.array(input.z);
    const auto free = queue.array(input.free);
    auto shape = queue.array<std::uint8_t>(static_cast<std::size_t>(input.params.rows) * input.params.cols);
    const int lanes = input.vector_width > 0 ? input.vector_width : queue.vector_width();
    const auto width = static_cast<std::size_t>(lanes);
    queue.launch(kName, queue.kernel(kName, {{"VW", lanes}}),
                 device::grid((input.params.cols + width - 1) / width, input.params.rows), input.params, x, y,
                 z, free, shape);
    return queue.read(shape);
  }
  static Expected reference(const Input& input);  // reference/window_planes.cpp

  static double items(const Input& input) {
    return static_cast<double>(input.params.rows) * static_cast<double>(input.params.cols);
  }
  static double bytes(const Input& input) { return 14 * items(input); }
  static double flops(const Input& input) { return 2000 * items(input); }
};

}  // namespace hybrid::testing
