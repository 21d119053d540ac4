#include "io/las/las_steps.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "core/parallel.hpp"

namespace hybrid::io {
namespace {

constexpr double kMostSteps = std::numeric_limits<std::int32_t>::max();
constexpr int kUsualDecimals = 5, kMostDecimals = 9;
constexpr std::size_t kReturnsAtOnce = 8192;

// Calls body(block, sample) for the returns, on all threads, until one is false.
template <typename Body>
bool for_returns(const ScanStream& scan, const Body& body) {
  std::atomic<bool> all{true};
  scan.for_each_block([&](const SampleBlock& block) {
    parallel_for((block.size() + kReturnsAtOnce - 1) / kReturnsAtOnce, [&](std::size_t part) {
      for (std::size_t i = part * kReturnsAtOnce, end = std::min(i + kReturnsAtOnce, block.size());
           i < end && all; ++i)
        if (is_return(block.points[i]) && !body(block, i)) all = false;
    });
    return all.load();
  });
  return all;
}

// Whole numbers stay what they are: the file's own steps, or those from a middle that is one of them.
void take_steps(const CoordinateSteps& of_file, const SampleFacts& facts, LasSteps& steps) {
  for (int axis = 0; axis < 3; ++axis) {
    double scale = of_file.scale[axis];
    const double offset = of_file.offset[axis];
    const auto whole = [&](double value) { return std::round((value - offset) / scale); };
    while (whole(facts.greatest_m[axis]) - whole(facts.least_m[axis]) > 2 * (kMostSteps - 1)) scale *= 10;
    const double low = whole(facts.least_m[axis]), high = whole(facts.greatest_m[axis]);
    const bool fits = low >= -kMostSteps && high <= kMostSteps;
    steps.scale[axis] = scale;
    steps.offset[axis] = fits ? offset : offset + std::round((low + high) / 2) * scale;
  }
}

// The value that a reader makes of it is the one that is here.
bool survives(const SampleBlock& block, std::size_t sample, const LasSteps& steps) {
  constexpr double kLastDigit = 8 * std::numeric_limits<double>::epsilon();
  const Vec3 point = block.exact_point(sample);
  for (int axis = 0; axis < 3; ++axis) {
    const double back = steps.back(point[axis], axis);
    if (block.exact.empty() ? static_cast<float>(back - block.scan->origin[axis]) !=
                                  block.points[sample][static_cast<std::size_t>(axis)]
                            : std::abs(back - point[axis]) >
                                  kLastDigit * std::max(std::abs(point[axis]), std::abs(steps.offset[axis])))
      return false;
  }
  return true;
}

bool all_survive(const ScanStream& scan, const LasSteps& steps) {
  return for_returns(scan,
                     [&](const SampleBlock& block, std::size_t i) { return survives(block, i, steps); });
}

double largest_rounding(const ScanStream& scan, const LasSteps& steps) {
  double largest = 0;
  scan.for_each_block([&](const SampleBlock& block) {
    std::vector<double> parts((block.size() + kReturnsAtOnce - 1) / kReturnsAtOnce, 0.0);
    parallel_for(parts.size(), [&](std::size_t part) {
      for (std::size_t i = part * kReturnsAtOnce, end = std::min(i + kReturnsAtOnce, block.size()); i < end;
           ++i) {
        if (!is_return(block.points[i])) continue;
        const Vec3 point = block.exact_point(i);
        for (int axis = 0; axis < 3; ++axis)
          parts[part] = std::max(parts[part], std::abs(steps.back(point[axis], axis) - point[axis]));
      }
    });
    largest = std::max(largest, *std::ranges::max_element(parts));
    return true;
  });
  return largest;
}

// Ten to this power, the double nearest to it.
double power_of_ten(int exponent) {
  return exponent < 0 ? 1 / std::pow(10.0, -exponent) : std::pow(10.0, exponent);
}

// Decimal steps about the middle.
bool choose_decimals(const ScanStream& scan, LasSteps& steps) {
  const SampleFacts& facts = scan.facts();
  for (int axis = 0; axis < 3; ++axis)
    steps.offset[axis] = std::round((facts.least_m[axis] + facts.greatest_m[axis]) / 2) + 0.0;
  const double farthest = (facts.greatest_m - steps.offset).cwiseMax(steps.offset - facts.least_m).maxCoeff();
  const auto fits = [&](int decimals) { return farthest / power_of_ten(-decimals) < kMostSteps; };
  int decimals = kUsualDecimals;
  while (!fits(decimals)) --decimals;
  for (;; ++decimals) {
    steps.scale = Vec3::Constant(power_of_ten(-decimals));
    if (all_survive(scan, steps)) return true;
    if (decimals >= kMostDecimals || !fits(decimals + 1)) return false;
  }
}

LasSteps choose_steps(const ScanStream& scan) {
  LasSteps steps;
  const SampleFacts& facts = scan.facts();
  const auto& of_file = scan.head().steps;
  if (facts.returns == 0) return steps;
  bool all = false;
  if (of_file && scan.has_exact() && (of_file->scale.array() > 0).all()) {
    take_steps(*of_file, facts, steps);
    all = steps.scale == of_file->scale;
  } else {
    all = choose_decimals(scan, steps);
  }
  if (!all) steps.rounding_m = largest_rounding(scan, steps);
  for (int axis = 0; axis < 3; ++axis) {
    steps.minimum[axis] = steps.back(facts.least_m[axis], axis);
    steps.maximum[axis] = steps.back(facts.greatest_m[axis], axis);
  }
  return steps;
}

}  // namespace

std::int32_t LasSteps::whole(double value, int axis) const {
  return static_cast<std::int32_t>(std::lround((value - offset[axis]) / scale[axis]));
}

const LasSteps& ScanStream::las_steps() const {
  if (!las_steps_) las_steps_ = std::make_shared<const LasSteps>(choose_steps(*this));
  return *las_steps_;
}

}  // namespace hybrid::io
