#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "device/queue.hpp"
#include "shared/params_square_planes.h"
#include "shared/records.h"
#include "stages/planes/square_planes.hpp"

namespace hybrid::testing {

struct SquarePlanesCase {
  static constexpr const char* kName = "square_planes";
  struct Input {
    SquarePlanesParams params;
    int square;
    int vector_width;  // 0 = the queue's
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> triplets;
    std::size_t square_rows() const { return (params.rows + side() - 1) / side(); }
    std::size_t square_cols() const { return (params.cols + side() - 1) / side(); }
    std::size_t side() const { return static_cast<std::size_t>(square); }
  };
  using Output = std::vector<SquareRecord>;

  // A nearly square image of at least `size` samples at 1 mrad, the surplus NaN: facets of 23 x 31 samples 3
  // to 8 m away, tilted up to 70 degrees, one in eight a cloud of points, 2 mm of noise along the ray, 5 %
  // missing, 3 % half a metre off.
  static Input make(std::size_t size, std::uint32_t seed, int square = 5) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> uniform;
    const auto cols = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(size))));
    const std::size_t rows = cols == 0 ? 0 : (size + cols - 1) / cols;
    Input input{{}, square, 0, {}, {}, {}, stages::sample_triplets(square, seed)};
    input.params = {static_cast<std::uint32_t>(rows),
                    static_cast<std::uint32_t>(cols),
                    0,
                    0,
                    32,
                    seed,
                    SQUARE_SCORE_MSAC,
                    SQUARE_FIT_RANSAC,
                    static_cast<std::uint32_t>(std::ceil(0.7 * square * square - 1e-9)),
                    0.8f,
                    0.008f,
                    0.002f,
                    0.05f,
                    {}};
    struct Facet {
      float range, by_row, by_col;
      bool cloud;
    };
    std::vector<Facet> facets;
    for (std::size_t f = 0; f < (rows / 23 + 1) * (cols / 31 + 1); ++f)
      facets.push_back({3 + 5 * uniform(random), 2.7f * (2 * uniform(random) - 1),
                        2.7f * (2 * uniform(random) - 1), uniform(random) < 0.125f});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < rows * cols; ++i) {
      const std::size_t row = i / cols, col = i % cols;
      const Facet& facet = facets[row / 23 * (cols / 31 + 1) + col / 31];
      const float elevation = -0.001f * static_cast<float>(row), azimuth = 0.001f * static_cast<float>(col);
      // A plane is linear in inverse range over small angles; exactly: over tangents from the facet's middle.
      const float up = std::tan(0.001f * (static_cast<float>(row % 23) - 11)),
                  along = std::tan(0.001f * (static_cast<float>(col % 31) - 15));
      float range = facet.range / (1 + facet.by_row * up + facet.by_col * along) *
                    std::sqrt(1 + up * up + along * along);
      if (facet.cloud) range += uniform(random);
      range += 0.002f * normal(random);
      const float chance = uniform(random);
      if (chance < 0.03f) range += 0.5f;
      if (chance > 0.95f || i >= size) range = nan;
      input.x.push_back(range * std::cos(elevation) * std::cos(azimuth));
      input.y.push_back(range * std::cos(elevation) * std::sin(azimuth));
      input.z.push_back(range * std::sin(elevation));
    }
    return input;
  }

  static Output run(device::Queue& queue, const Input& input) {
    const int lanes = input.vector_width > 0 ? input.vector_width : queue.vector_width();
    const auto width = static_cast<std::size_t>(lanes);
    const auto x = queue.array(input.x), y = queue.array(input.y), z = queue.array(input.z);
    const auto triplets = queue.array(input.triplets);
    auto records = queue.array<SquareRecord>(input.square_rows() * input.square_cols());
    queue.launch(kName, queue.kernel(kName, {{"VW", lanes}, {"SQUARE", input.square}}),
                 device::grid((input.square_cols() + width - 1) / width * input.square_rows()), input.params,
                 x, y, z, triplets, records);
    return queue.read(records);
  }
  static Output reference(const Input& input);  // reference/square_planes.cpp

  static double items(const Input& input) { return static_cast<double>(input.x.size()); }
  static double bytes(const Input& input) {
    return 12.0 * items(input) + 80.0 * static_cast<double>(input.square_rows() * input.square_cols());
  }
  static double flops(const Input& input) { return items(input) * (12.0 * input.params.hypotheses + 90.0); }

  // A sample on the threshold, or two test planes of one score, may fall either way in float: so many squares
  // may end with other inliers or another state.
  static constexpr double kOtherShare = 0.005;
  // Where the inliers agree: directions from float scatters whose extents differ up to a hundredfold, and
  // distances of a few roundings at 10 m.
  static constexpr double kAngleRad = 2e-4, kDistanceM = 4e-6;
};

}  // namespace hybrid::testing
