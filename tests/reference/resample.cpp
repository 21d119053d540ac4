#include <cmath>
#include <optional>

#include "cases/resample_case.hpp"

namespace hybrid::testing {
namespace {

struct Column {
  const ResampleCase::Input& input;
  std::size_t from, to;
  double at(std::size_t k) const { return input.position[k]; }
  double range(std::size_t k) const { return input.sample[k][3]; }

  double slope(std::size_t a, std::size_t b) const {
    const double arc = std::min(range(a), range(b)) * std::abs(at(b) - at(a)) * input.params.step_rad;
    return std::abs(range(a) - range(b)) / arc;
  }
  // Slope to the nearest sample beside k at least half a row and at most max_gap away.
  std::optional<double> slope_beside(std::size_t k, bool above) const {
    std::optional<std::size_t> best;
    for (std::size_t j = from; j < to; ++j) {
      if (above ? j >= k : j <= k) continue;
      const double rows = std::abs(at(j) - at(k));
      if (rows < 0.5 || rows > input.params.max_gap) continue;
      if (!best || rows < std::abs(at(*best) - at(k))) best = j;
    }
    return best ? std::optional(slope(k, *best)) : std::nullopt;
  }
  bool jumps(std::size_t a, std::size_t b) const {
    const auto above = slope_beside(a, true), below = slope_beside(b, false);
    double local = 0;
    if (above && below)
      local = std::min(*above, *below);
    else if (above || below)
      local = above ? *above : *below;
    const double arc = std::min(range(a), range(b)) * (at(b) - at(a)) * input.params.step_rad;
    return std::abs(range(a) - range(b)) >
           input.params.jump_m + (input.params.jump_slope + input.params.jump_factor * local) * arc;
  }
};

}  // namespace

ResampleCase::Output ResampleCase::reference(const Input& input) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t n = input.nodes(), cols = input.params.cols;
  Output out{std::vector(n, nan),
             std::vector(n, nan),
             std::vector(n, nan),
             std::vector(n, nan),
             std::vector<std::uint8_t>(n, RESAMPLE_EMPTY),
             std::vector<std::uint32_t>(n, RESAMPLE_NO_SAMPLE)};
  for (std::size_t node = 0; node < n; ++node) {
    const std::size_t row = node / cols, col = node % cols;
    const Column column{input, input.begin[col], input.begin[col + 1]};
    const double at = static_cast<double>(input.params.first_row + row);
    std::optional<std::size_t> nearest, above, below;
    for (std::size_t k = column.from; k < column.to; ++k) {
      const double off = column.at(k) - at;
      if (off >= -0.5 && off < 0.5 && (!nearest || std::abs(off) < std::abs(column.at(*nearest) - at)))
        nearest = k;
      if (off < 0) above = k;
      if (off > 0 && !below) below = k;
    }
    std::array<double, 4> value{};
    if (nearest) {
      for (int i = 0; i < 4; ++i) value[i] = input.sample[*nearest][i];
      out.mask[node] = RESAMPLE_MEASURED;
      out.pick[node] = static_cast<std::uint32_t>(*nearest);
    } else if (above && below && column.at(*below) - column.at(*above) <= input.params.max_gap &&
               !column.jumps(*above, *below)) {
      const double a = column.at(*above), b = column.at(*below);
      const double r = (column.range(*above) * (b - at) + column.range(*below) * (at - a)) / (b - a);
      const auto& elevation = input.ray_row[row];
      const auto& azimuth = input.ray_col[col];
      value = {r * elevation[0] * azimuth[0], r * elevation[0] * azimuth[1], r * elevation[1], r};
      out.mask[node] = RESAMPLE_INTERPOLATED;
    } else {
      continue;
    }
    out.x[node] = static_cast<float>(value[0]);
    out.y[node] = static_cast<float>(value[1]);
    out.z[node] = static_cast<float>(value[2]);
    out.range[node] = static_cast<float>(value[3]);
  }
  return out;
}

}  // namespace hybrid::testing
