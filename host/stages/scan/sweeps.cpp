#include "stages/scan/sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/median.hpp"
#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSteepRad = 1.47;      // about 84 degrees: beyond, a sample's azimuth is mostly noise
constexpr double kSidewaysShare = 0.4;  // of a column step: more is another column
constexpr double kSidewaysNoise = 8;    // median offsets between neighbours that noise may reach
constexpr double kMinimumSamples = 6;   // in the sweep that the median sample belongs to
constexpr double kClusterRatio = 5;     // between the gaps within columns and those between them
constexpr std::size_t kMinimumColumns = 4;

std::vector<std::uint32_t> returns(const SampleAngles& angles) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < angles.elevation_rad.size(); ++i)
    if (!std::isnan(angles.elevation_rad[i])) found.push_back(static_cast<std::uint32_t>(i));
  return found;
}

void add_azimuths(const SampleAngles& angles, Sweeps& sweeps) {
  sweeps.azimuth_rad.assign(sweeps.begin.size() - 1, 0.0);
  parallel_for(sweeps.count(), [&](std::size_t s) {
    double x = 0, y = 0;
    for (std::size_t k = sweeps.begin[s]; k < sweeps.begin[s + 1]; ++k) {
      const std::size_t i = sweeps.samples[k];
      const double level = std::cos(angles.elevation_rad[i]);
      x += level * std::cos(angles.azimuth_rad[i]);
      y += level * std::sin(angles.azimuth_rad[i]);
    }
    sweeps.azimuth_rad[s] = std::atan2(y, x);
  });
}

// How far apart in azimuth, and how near to the vertical axis, where that means least.
double azimuth_between(const SampleAngles& angles, std::size_t a, std::size_t b) {
  return std::abs(wrapped(angles.azimuth_rad[a] - angles.azimuth_rad[b]));
}
double nearer(const SampleAngles& angles, std::size_t a, std::size_t b) {
  return std::min(angles.horizontal_m[a], angles.horizontal_m[b]);
}

struct CutRule {
  double elevation_step_rad;  // the elevation turns back by over half of it: a new sweep
  double widest_azimuth_rad;  // ... as does a step sideways of more than this and the noise
  double noise_m;             // sideways
};

Sweeps cut(const SampleAngles& angles, const std::vector<std::uint32_t>& order, const CutRule& rule) {
  Sweeps sweeps{order, {0}, {}};
  double direction = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const double rise = angles.elevation_rad[order[k]] - angles.elevation_rad[order[k - 1]];
    const bool moves = std::abs(rise) > 0.5 * rule.elevation_step_rad;
    // In metres, so that near the vertical axis, where azimuths are mostly noise, little counts.
    const double aside = azimuth_between(angles, order[k], order[k - 1]) - rule.widest_azimuth_rad;
    if ((moves && rise * direction < 0) || aside * nearer(angles, order[k], order[k - 1]) > rule.noise_m) {
      sweeps.begin.push_back(k);
      direction = 0;
    } else if (direction == 0 && moves) {
      direction = rise;
    }
  }
  sweeps.begin.push_back(order.size());
  add_azimuths(angles, sweeps);
  return sweeps;
}

double azimuth_step(const Sweeps& sweeps) {
  std::vector<double> differences;
  for (std::size_t s = 1; s < sweeps.count(); ++s)
    differences.push_back(std::abs(wrapped(sweeps.azimuth_rad[s] - sweeps.azimuth_rad[s - 1])));
  return typical_step(std::move(differences));
}

// Root mean square of the azimuths around the sweep's own, away from the zenith.
double spread(const SampleAngles& angles, const Sweeps& sweeps, std::size_t s) {
  double sum = 0, count = 0;
  for (std::size_t k = sweeps.begin[s]; k < sweeps.begin[s + 1]; ++k) {
    const std::size_t i = sweeps.samples[k];
    if (std::abs(angles.elevation_rad[i]) >= kSteepRad) continue;
    const double off = wrapped(angles.azimuth_rad[i] - sweeps.azimuth_rad[s]);
    sum += off * off;
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

// Of the sweep the median sample belongs to, when sweeps are ordered by `value`.
double sample_median(const Sweeps& sweeps, const std::vector<double>& value) {
  std::vector<std::size_t> order(sweeps.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return value[a] < value[b]; });
  std::size_t passed = 0;
  for (const std::size_t s : order) {
    passed += sweeps.begin[s + 1] - sweeps.begin[s];
    if (2 * passed >= sweeps.samples.size()) return value[s];
  }
  return 0;
}

bool are_columns(const SampleAngles& angles, const Sweeps& sweeps, double step) {
  std::vector<double> length, width(sweeps.count());
  for (std::size_t s = 0; s < sweeps.count(); ++s)
    length.push_back(static_cast<double>(sweeps.begin[s + 1] - sweeps.begin[s]));
  parallel_for(sweeps.count(), [&](std::size_t s) { width[s] = spread(angles, sweeps, s); });
  const double widest = step > 0 ? 0.75 * step : 1e-3;  // a lone column has no neighbour to compare with
  return sample_median(sweeps, length) >= kMinimumSamples && sample_median(sweeps, width) < widest;
}

}  // namespace

double wrapped(double angle) {
  const double turn = 2 * std::numbers::pi;
  return angle - turn * std::floor((angle + std::numbers::pi) / turn);
}

double typical_step(std::vector<double> differences) {
  std::erase_if(differences, [](double d) { return !(d > 0); });
  if (differences.empty()) return 0;
  std::sort(differences.begin(), differences.end());
  const double least = 0.25 * differences[(differences.size() - 1) * 9 / 10];
  const auto first = std::lower_bound(differences.begin(), differences.end(), least);
  return *(first + (differences.end() - first) / 2);
}

SampleAngles sample_angles(const Scan& scan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SampleAngles angles{std::vector<double>(scan.points.size(), nan),
                      std::vector<double>(scan.points.size(), nan),
                      std::vector<float>(scan.points.size(), 0.0f)};
  parallel_for(
      scan.points.size(),
      [&](std::size_t i) {
        const auto& p = scan.points[i];
        const double x = scan.origin.x() + p[0], y = scan.origin.y() + p[1], z = scan.origin.z() + p[2];
        const double length = x * x + y * y + z * z;
        if (!std::isfinite(length) || length == 0) return;
        angles.azimuth_rad[i] = std::atan2(y, x);
        angles.horizontal_m[i] = static_cast<float>(std::hypot(x, y));
        angles.elevation_rad[i] = std::atan2(z, std::hypot(x, y));
      },
      4096);
  return angles;
}

Sweeps sweeps_of_acquisition(const SampleAngles& angles) {
  const auto order = returns(angles);
  if (order.size() < kMinimumSamples) return {};
  std::vector<double> rises, offsets;
  const std::size_t stride = 1 + order.size() / 1'000'000;  // a million differences settle a median
  for (std::size_t k = 1; k < order.size(); k += stride) {
    const std::size_t i = order[k], before = order[k - 1];
    rises.push_back(std::abs(angles.elevation_rad[i] - angles.elevation_rad[before]));
    offsets.push_back(azimuth_between(angles, i, before) * nearer(angles, i, before));
  }
  CutRule rule{median(rises), std::numbers::pi, kSidewaysNoise * median(offsets)};

  // Each cut shows better how far apart columns are, the next one uses it.
  Sweeps sweeps = cut(angles, order, rule);
  for (int pass = 0; pass < 2; ++pass) {
    const double step = azimuth_step(sweeps);
    if (step <= 0) break;
    rule.widest_azimuth_rad = kSidewaysShare * step;
    sweeps = cut(angles, order, rule);
  }
  return are_columns(angles, sweeps, azimuth_step(sweeps)) ? sweeps : Sweeps{};
}

Sweeps sweeps_of_azimuth(const SampleAngles& angles) {
  auto order = returns(angles);
  const auto tail = std::stable_partition(
      order.begin(), order.end(), [&](auto i) { return std::abs(angles.elevation_rad[i]) < kSteepRad; });
  const std::size_t level = static_cast<std::size_t>(tail - order.begin());
  if (level < kMinimumColumns * kMinimumColumns) return {};
  std::stable_sort(order.begin(), tail,
                   [&](auto a, auto b) { return angles.azimuth_rad[a] < angles.azimuth_rad[b]; });
  std::vector<double> gaps;
  for (std::size_t k = 1; k < level; ++k)
    gaps.push_back(angles.azimuth_rad[order[k]] - angles.azimuth_rad[order[k - 1]]);
  auto sorted = gaps;
  std::sort(sorted.begin(), sorted.end(), std::greater<>());

  double best = 0, threshold = 0;
  const double least = 1e-9;  // gaps of rounding size count as none
  for (std::size_t n = kMinimumColumns; n + 1 < sorted.size() && n < level / kMinimumColumns; ++n) {
    const double ratio = (sorted[n - 1] + least) / (sorted[n] + least);
    if (ratio <= best) continue;
    best = ratio;
    threshold = std::sqrt((sorted[n - 1] + least) * (sorted[n] + least));
  }
  if (best < kClusterRatio) return {};

  std::vector<std::vector<std::uint32_t>> columns(1);
  std::vector<double> azimuths{angles.azimuth_rad[order[0]]};
  for (std::size_t k = 0; k < level; ++k) {
    if (k > 0 && gaps[k - 1] > threshold) {
      columns.emplace_back();
      azimuths.push_back(angles.azimuth_rad[order[k]]);
    }
    columns.back().push_back(order[k]);
  }
  for (auto sample = tail; sample != order.end(); ++sample) {
    const double azimuth = angles.azimuth_rad[*sample];
    const auto after = std::lower_bound(azimuths.begin(), azimuths.end(), azimuth);
    std::size_t c = static_cast<std::size_t>(after - azimuths.begin()) % azimuths.size();
    const std::size_t previous = (c + azimuths.size() - 1) % azimuths.size();
    if (std::abs(wrapped(azimuth - azimuths[previous])) < std::abs(wrapped(azimuth - azimuths[c])))
      c = previous;
    columns[c].push_back(*sample);
  }

  Sweeps sweeps{{}, {0}, {}};
  for (const auto& column : columns) {
    sweeps.samples.insert(sweeps.samples.end(), column.begin(), column.end());
    sweeps.begin.push_back(sweeps.samples.size());
  }
  add_azimuths(angles, sweeps);
  return sweeps;
}

}  // namespace hybrid::stages
