#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_decimate.h"

namespace hybrid::testing {

// A tile that begins inside its image, every combination of mask, label, boundary and class.
struct DecimateCase {
  static constexpr const char* kName = "decimate";
  struct Input {
    DecimateParams params;
    std::vector<std::uint8_t> mask, boundary, square_class;
    std::vector<std::uint32_t> label;
  };
  using Output = std::vector<std::uint8_t>;

  static Input make(std::size_t size, std::uint32_t seed) {
    Input input{};
    const auto cols = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const auto rows = cols ? static_cast<std::uint32_t>((size + cols - 1) / cols) : 0u;
    const std::uint32_t square = 4, first_row = 8, first_col = 12;
    const std::uint32_t square_cols = (first_col + cols + square - 1) / square;
    input.params = {first_row, first_col, rows, cols, square, square_cols, seed % 2, 0};
    std::mt19937 random(seed);
    for (std::uint32_t i = 0; i < rows * cols; ++i) {
      input.mask.push_back(static_cast<std::uint8_t>(random() % 3));
      input.boundary.push_back(random() % 5 == 0);
      input.label.push_back(random() % 3);
    }
    for (std::uint32_t i = 0; i < (first_row + rows + square - 1) / square * square_cols; ++i)
      input.square_class.push_back(static_cast<std::uint8_t>(random() % 4));
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto mask = queue.array(input.mask), boundary = queue.array(input.boundary);
    const auto square_class = queue.array(input.square_class);
    const auto label = queue.array(input.label);
    auto fate = queue.array<std::uint8_t>(input.mask.size());
    queue.launch(kName, queue.kernel(kName), device::grid(input.params.cols, input.params.rows), input.params,
                 mask, label, boundary, square_class, fate);
    return queue.read(fate);
  }
  static Output reference(const Input& input);  // reference/decimate.cpp

  static double items(const Input& input) { return static_cast<double>(input.mask.size()); }
  static double bytes(const Input& input) { return 7 * items(input); }
  static double flops(const Input& input) { return 10 * items(input); }
};

}  // namespace hybrid::testing
