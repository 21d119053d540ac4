#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_contour_cells.h"

namespace hybrid::testing {

// Labels 0 to 3 in blocks with specks, so that all 2^4 codes and cells of four labels occur.
struct ContourCellsCase {
  static constexpr const char* kName = "contour_cells";
  struct Input {
    ContourCellParams params;
    std::vector<std::uint32_t> labels;
  };
  using Output = std::vector<std::uint16_t>;

  static Input make(std::size_t size, std::uint32_t seed) {
    Input input{};
    const auto cols = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const auto rows = cols ? static_cast<std::uint32_t>((size + cols - 1) / cols) : 0u;
    input.params = {rows, cols, {}};
    std::mt19937 random(seed);
    for (std::uint32_t i = 0; i < (rows + 1) * (cols + 1); ++i) {
      const std::uint32_t row = i / (cols + 1), col = i % (cols + 1);
      input.labels.push_back(random() % 5 == 0 ? random() % 4 : (row / 13 + col / 11) % 4);
    }
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto labels = queue.array(input.labels);
    auto codes = queue.array<std::uint16_t>(std::size_t{input.params.rows} * input.params.cols);
    queue.launch(kName, queue.kernel(kName), device::grid(input.params.cols, input.params.rows), input.params,
                 labels, codes);
    return queue.read(codes);
  }
  static Output reference(const Input& input);  // reference/contour_cells.cpp

  static double items(const Input& input) { return double(input.params.rows) * input.params.cols; }
  static double bytes(const Input& input) { return 6 * items(input); }
  static double flops(const Input& input) { return 20 * items(input); }
};

}  // namespace hybrid::testing
