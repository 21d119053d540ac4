#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/lanes.hpp"
#include "geometry/range_image.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// Normal equations of a correction to m = normal / offset that minimises the weighted squares of the
// residuals along the rays, r (1 - m . p), in the plane's own axes.
struct RayEquations {
  struct Frame {
    Mat3 axes;  // rows: normal and two across
    Vec3 m;
    const RangeNoise* noise;  // null: not wanted
  };
  // Matrix xx xy xz yy yz zz, right side; weights, and derivatives of what each sample pulls with.
  static constexpr std::size_t kTerms = 11;
  struct Sums {
    std::array<double, kTerms> of{};
    std::int64_t samples = 0;

    void add(const Sums& other, double weight);
    // Weighted least squares goes but a part of the way, as the weights hold to the plane they were made for;
    // Newton's step is longer by this, on the average.
    double step() const;
  };
  // A sum for each lane of a vector.
  struct Lanes {
    alignas(64) std::array<LaneValues, kTerms> of{};
    alignas(64) LaneValues samples{};

    Sums total() const;
  };
  Lanes inner, border;  // where another surface begins near by

  // The measured samples of the label among `count` nodes of one row, with Tukey's biweight.
  void add_nodes(const RangeImage& image, const std::vector<std::uint32_t>& labels, std::size_t first,
                 std::size_t count, std::uint32_t label, const Frame& frame);
  void merge(const RayEquations& other);
  // Of both, when one of `stride` samples was added: those at the border err together, and say little.
  Sums weighted(int stride) const;
};

}  // namespace hybrid::stages
