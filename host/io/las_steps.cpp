#include "io/las_steps.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"

namespace hybrid::io {
namespace {

constexpr double kMostSteps = std::numeric_limits<std::int32_t>::max();
constexpr int kUsualDecimals = 5, kMostDecimals = 9;
constexpr std::size_t kBlock = 1 << 16;

template <typename Body>  // body(block, first, end)
void for_blocks(std::size_t count, const Body& body) {
  parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
    body(block, block * kBlock, std::min((block + 1) * kBlock, count));
  });
}

struct Extent {
  Vec3 least = Vec3::Constant(INFINITY), greatest = Vec3::Constant(-INFINITY);
};

Extent extent_of(const Scan& scan, const std::vector<std::uint32_t>& returns) {
  std::vector<Extent> parts(returns.size() / kBlock + 1);
  for_blocks(returns.size(), [&](std::size_t block, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const Vec3 point = scan.exact_point(returns[i]);
      parts[block].least = parts[block].least.cwiseMin(point);
      parts[block].greatest = parts[block].greatest.cwiseMax(point);
    }
  });
  Extent all;
  for (const Extent& part : parts) {
    all.least = all.least.cwiseMin(part.least);
    all.greatest = all.greatest.cwiseMax(part.greatest);
  }
  return all;
}

// Whole numbers stay what they are: the file's own steps, or those from a middle that is one of them.
void take_steps(const CoordinateSteps& of_file, const Extent& extent, LasSteps& steps) {
  for (int axis = 0; axis < 3; ++axis) {
    double scale = of_file.scale[axis];
    const double offset = of_file.offset[axis];
    const auto whole = [&](double value) { return std::round((value - offset) / scale); };
    while (whole(extent.greatest[axis]) - whole(extent.least[axis]) > 2 * (kMostSteps - 1)) scale *= 10;
    const double low = whole(extent.least[axis]), high = whole(extent.greatest[axis]);
    const bool fits = low >= -kMostSteps && high <= kMostSteps;
    steps.scale[axis] = scale;
    steps.offset[axis] = fits ? offset : offset + std::round((low + high) / 2) * scale;
  }
}

// The value that a reader makes of it is the one that is here.
bool survives(const Scan& scan, std::size_t sample, const LasSteps& steps) {
  constexpr double kLastDigit = 8 * std::numeric_limits<double>::epsilon();
  const Vec3 point = scan.exact_point(sample);
  for (int axis = 0; axis < 3; ++axis) {
    const double back = steps.back(point[axis], axis);
    if (scan.exact.empty() ? static_cast<float>(back - scan.origin[axis]) !=
                                 scan.points[sample][static_cast<std::size_t>(axis)]
                           : std::abs(back - point[axis]) >
                                 kLastDigit * std::max(std::abs(point[axis]), std::abs(steps.offset[axis])))
      return false;
  }
  return true;
}

bool all_survive(const Scan& scan, const std::vector<std::uint32_t>& returns, const LasSteps& steps) {
  std::atomic<bool> all{true};
  for_blocks(returns.size(), [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end && all; ++i)
      if (!survives(scan, returns[i], steps)) all = false;
  });
  return all;
}

double largest_rounding(const Scan& scan, const std::vector<std::uint32_t>& returns, const LasSteps& steps) {
  std::vector<double> parts(returns.size() / kBlock + 1, 0.0);
  for_blocks(returns.size(), [&](std::size_t block, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const Vec3 point = scan.exact_point(returns[i]);
      for (int axis = 0; axis < 3; ++axis)
        parts[block] = std::max(parts[block], std::abs(steps.back(point[axis], axis) - point[axis]));
    }
  });
  return *std::ranges::max_element(parts);
}

// Ten to this power, the double nearest to it.
double power_of_ten(int exponent) {
  return exponent < 0 ? 1 / std::pow(10.0, -exponent) : std::pow(10.0, exponent);
}

// Decimal steps about the middle.
bool choose_decimals(const Scan& scan, const std::vector<std::uint32_t>& returns, const Extent& extent,
                     LasSteps& steps) {
  for (int axis = 0; axis < 3; ++axis)
    steps.offset[axis] = std::round((extent.least[axis] + extent.greatest[axis]) / 2) + 0.0;
  const double farthest = (extent.greatest - steps.offset).cwiseMax(steps.offset - extent.least).maxCoeff();
  const auto fits = [&](int decimals) { return farthest / power_of_ten(-decimals) < kMostSteps; };
  int decimals = kUsualDecimals;
  while (!fits(decimals)) --decimals;
  for (;; ++decimals) {
    steps.scale = Vec3::Constant(power_of_ten(-decimals));
    if (all_survive(scan, returns, steps)) return true;
    if (decimals >= kMostDecimals || !fits(decimals + 1)) return false;
  }
}

}  // namespace

std::int32_t LasSteps::whole(double value, int axis) const {
  return static_cast<std::int32_t>(std::lround((value - offset[axis]) / scale[axis]));
}

LasSteps choose_las_steps(const Scan& scan, const std::vector<std::uint32_t>& returns) {
  LasSteps steps;
  if (returns.empty()) return steps;
  const Extent extent = extent_of(scan, returns);
  bool all = false;
  if (scan.steps && !scan.exact.empty() && (scan.steps->scale.array() > 0).all()) {
    take_steps(*scan.steps, extent, steps);
    all = steps.scale == scan.steps->scale;
  } else {
    all = choose_decimals(scan, returns, extent, steps);
  }
  if (!all) steps.rounding_m = largest_rounding(scan, returns, steps);
  for (int axis = 0; axis < 3; ++axis) {
    steps.minimum[axis] = steps.back(extent.least[axis], axis);
    steps.maximum[axis] = steps.back(extent.greatest[axis], axis);
  }
  return steps;
}

}  // namespace hybrid::io
