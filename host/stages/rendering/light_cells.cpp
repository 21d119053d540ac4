#include "stages/rendering/light_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"

namespace hybrid::stages {
namespace {

constexpr int kDarkest = 8, kBrightest = 247;
constexpr double kCellsPerReach = 8;

}  // namespace

LightCells::LightCells(const Image8& image, double reach_px)
    : step_(std::max(1, static_cast<int>(reach_px / kCellsPerReach))),
      cols_((image.width + step_ - 1) / step_),
      rows_((image.height + step_ - 1) / step_),
      width_(image.width),
      height_(image.height),
      reach_(reach_px),
      mean_(static_cast<std::size_t>(cols_) * static_cast<std::size_t>(rows_)) {
  const auto& linear = linear_of_bytes<float>();
  const auto cell = [&](int col, int row) -> std::array<float, 3> {
    std::array<double, 3> sum{};
    const int left = col * step_, right = std::min(left + step_, width_), top = row * step_,
              bottom = std::min(top + step_, height_);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const std::uint8_t* bytes = image.at(x, y);
        const bool masked = image.channels == 4 && bytes[3] == 0;
        const auto [darkest, brightest] = std::minmax({bytes[0], bytes[1], bytes[2]});
        if (masked || darkest < kDarkest || brightest > kBrightest) return {NAN, NAN, NAN};
        for (std::size_t k = 0; k < 3; ++k) sum[k] += static_cast<double>(linear[bytes[k]]);
      }
    const double pixels = (right - left) * (bottom - top);
    return {static_cast<float>(sum[0] / pixels), static_cast<float>(sum[1] / pixels),
            static_cast<float>(sum[2] / pixels)};
  };
  parallel_for(static_cast<std::size_t>(rows_), [&](std::size_t row) {
    for (int col = 0; col < cols_; ++col)
      mean_[row * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col)] =
          cell(col, static_cast<int>(row));
  });
}

LogLight LightCells::around(const Vec2& position) const {
  const int left = std::max(0, static_cast<int>(position.x() - reach_)) / step_,
            right = std::min(width_ - 1, static_cast<int>(position.x() + reach_)) / step_,
            top = std::max(0, static_cast<int>(position.y() - reach_)) / step_,
            bottom = std::min(height_ - 1, static_cast<int>(position.y() + reach_)) / step_;
  std::array<double, 3> sum{};
  double pixels = 0;
  for (int row = top; row <= bottom; ++row) {
    const int high = std::min(step_, height_ - row * step_);
    for (int col = left; col <= right; ++col) {
      const auto& mean = mean_[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) +
                               static_cast<std::size_t>(col)];
      if (std::isnan(mean[0])) return {NAN, NAN, NAN};
      const double share = high * std::min(step_, width_ - col * step_);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += share * static_cast<double>(mean[k]);
      pixels += share;
    }
  }
  LogLight light{NAN, NAN, NAN};
  for (std::size_t k = 0; k < 3 && pixels > 0; ++k) light[k] = static_cast<float>(std::log(sum[k] / pixels));
  return light;
}

}  // namespace hybrid::stages
