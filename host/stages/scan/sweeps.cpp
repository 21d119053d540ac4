#include "stages/scan/sweeps.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/group_items.hpp"
#include "core/median.hpp"
#include "core/parallel_blocks.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSteepRad = 1.47;          // about 84 degrees: beyond, a sample's azimuth is mostly noise
constexpr double kSidewaysShare = 0.4;      // of a column step: more is another column
constexpr double kSidewaysNoise = 8;        // median offsets between neighbours that noise may reach
constexpr std::size_t kMinimumSamples = 6;  // in the sweep that the median sample belongs to
constexpr double kClusterRatio = 5;         // between the gaps within columns and those between them
constexpr std::size_t kMinimumColumns = 4;

std::vector<std::uint32_t> returns(const SampleAngles& angles) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < angles.elevation_rad.size(); ++i)
    if (!std::isnan(angles.elevation_rad[i])) found.push_back(static_cast<std::uint32_t>(i));
  return found;
}

// The part of a sample's direction across the vertical axis: as long as its elevation's cosine.
std::array<double, 2> level_direction(const SampleAngles& angles, std::size_t i) {
  const Vec3 p = angles.scan.point(i);
  const double length = p.norm();
  return {p.x() / length, p.y() / length};
}

void add_azimuths(const SampleAngles& angles, Sweeps& sweeps) {
  sweeps.azimuth_rad.assign(sweeps.begin.size() - 1, 0.0);
  parallel_for(sweeps.count(), [&](std::size_t s) {
    double x = 0, y = 0;
    for (std::size_t k = sweeps.begin[s]; k < sweeps.begin[s + 1]; ++k) {
      const auto level = level_direction(angles, sweeps.samples[k]);
      x += level[0];
      y += level[1];
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

// Follows the mirror from sample to sample, and says where a new sweep begins.
struct Mirror {
  const SampleAngles& angles;
  const std::vector<std::uint32_t>& order;
  const CutRule& rule;

  // From order[k - 1] to order[k]. `direction` is that of the sweep, 1 up, -1 down, 0 where it is not known
  // yet.
  bool turns(std::size_t k, int& direction) const {
    const double rise = angles.elevation_rad[order[k]] - angles.elevation_rad[order[k - 1]];
    const int moves = std::abs(rise) > 0.5 * rule.elevation_step_rad ? (rise > 0) - (rise < 0) : 0;
    // In metres, so that near the vertical axis, where azimuths are mostly noise, little counts.
    const double aside = azimuth_between(angles, order[k], order[k - 1]) - rule.widest_azimuth_rad;
    if (moves * direction < 0 || aside * nearer(angles, order[k], order[k - 1]) > rule.noise_m) {
      direction = 0;
      return true;
    }
    if (direction == 0) direction = moves;
    return false;
  }
};

// Whether most samples lie in sweeps long enough for columns.
bool are_long(const Sweeps& sweeps) {
  std::size_t in_long = 0;
  for (std::size_t s = 0; s + 1 < sweeps.begin.size(); ++s)
    if (const std::size_t length = sweeps.begin[s + 1] - sweeps.begin[s]; length >= kMinimumSamples)
      in_long += length;
  return 2 * in_long > sweeps.samples.size();
}

// Cuts the samples into sweeps; false where they are too short, as those of samples in any order. Each block
// begins as if the direction was not known; where it was, it is followed once more from the block's begin
// until both say the same, which is soon.
bool cut(const SampleAngles& angles, const CutRule& rule, Sweeps& sweeps) {
  constexpr std::size_t kBlock = 1 << 16;
  struct Cuts {
    std::vector<std::size_t> at;
    int direction = 0;  // after the block
  };
  const Mirror mirror{angles, sweeps.samples, rule};
  const std::size_t count = sweeps.samples.size();
  std::vector<Cuts> blocks((count + kBlock - 1) / kBlock);
  for_blocks(count, kBlock, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t k = std::max<std::size_t>(begin, 1); k < end; ++k)
      if (mirror.turns(k, blocks[block].direction)) blocks[block].at.push_back(k);
  });
  sweeps.begin = {0};
  int direction = 0;
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    const std::size_t end = std::min((block + 1) * kBlock, count);
    std::size_t k = std::max<std::size_t>(block * kBlock, 1);
    for (int unknown = 0; k < end && direction != unknown; ++k) {
      if (mirror.turns(k, direction)) sweeps.begin.push_back(k);
      mirror.turns(k, unknown);
    }
    const Cuts& cuts = blocks[block];
    sweeps.begin.insert(sweeps.begin.end(), std::lower_bound(cuts.at.begin(), cuts.at.end(), k),
                        cuts.at.end());
    if (k < end) direction = cuts.direction;
  }
  sweeps.begin.push_back(count);
  if (!are_long(sweeps)) return false;
  add_azimuths(angles, sweeps);
  return true;
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
  std::vector<double> width(sweeps.count());
  parallel_for(sweeps.count(), [&](std::size_t s) { width[s] = spread(angles, sweeps, s); });
  const double widest = step > 0 ? 0.75 * step : 1e-3;  // a lone column has no neighbour to compare with
  return sample_median(sweeps, width) < widest;
}

// Returns whose azimuth means something, in its order (ties by index), and the others, by index.
struct LevelSamples {
  std::vector<std::uint32_t> samples, steep;
};

LevelSamples level_by_azimuth(const SampleAngles& angles) {
  constexpr std::size_t kPerGroup = 4096;  // few enough for a core's own memory
  const std::size_t count = angles.azimuth_rad.size(), groups = count / kPerGroup + 1;
  const double per_rad = static_cast<double>(groups) / (2 * std::numbers::pi);
  auto grouped = group_items(
      count, groups + 1,
      [&](std::size_t i) {
        const double elevation = std::abs(angles.elevation_rad[i]);
        if (std::isnan(elevation)) return kNoGroup;
        if (elevation >= kSteepRad) return static_cast<std::uint32_t>(groups);
        return std::min(static_cast<std::uint32_t>((angles.azimuth_rad[i] + std::numbers::pi) * per_rad),
                        static_cast<std::uint32_t>(groups - 1));
      },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  const auto at = [&](std::size_t k) { return grouped.values.begin() + static_cast<std::ptrdiff_t>(k); };
  parallel_for(groups, [&](std::size_t group) {
    std::vector<std::pair<double, std::uint32_t>> keys;
    for (std::size_t k = grouped.begin[group]; k < grouped.begin[group + 1]; ++k)
      keys.emplace_back(angles.azimuth_rad[grouped.values[k]], grouped.values[k]);
    std::sort(keys.begin(), keys.end());
    std::transform(keys.begin(), keys.end(), at(grouped.begin[group]),
                   [](const auto& key) { return key.second; });
  });
  LevelSamples level{{}, {at(grouped.begin[groups]), grouped.values.end()}};
  grouped.values.resize(grouped.begin[groups]);
  level.samples = std::move(grouped.values);
  return level;
}

// Wider gaps are those between columns. 0 where gaps do not fall into two kinds.
template <typename GapBefore>
double gap_between_columns(const GapBefore& gap_before, std::size_t count) {
  std::vector<double> widest(count - 1);
  for_blocks(widest.size(), 1 << 16, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) widest[k] = gap_before(k + 1);
  });
  const std::size_t looked_at = std::min(count / kMinimumColumns + 1, widest.size());
  const auto end = widest.begin() + static_cast<std::ptrdiff_t>(looked_at);
  if (end != widest.end()) std::nth_element(widest.begin(), end - 1, widest.end(), std::greater<>());
  tbb::parallel_sort(widest.begin(), end, std::greater<>());

  double best = 0, threshold = 0;
  const double least = 1e-9;  // gaps of rounding size count as none
  for (std::size_t n = kMinimumColumns; n + 2 < count && n < count / kMinimumColumns; ++n) {
    const double ratio = (widest[n - 1] + least) / (widest[n] + least);
    if (ratio <= best) continue;
    best = ratio;
    threshold = std::sqrt((widest[n - 1] + least) * (widest[n] + least));
  }
  return best < kClusterRatio ? 0 : threshold;
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
  SampleAngles angles{scan, std::vector<double>(scan.points.size(), nan),
                      std::vector<double>(scan.points.size(), nan),
                      std::vector<float>(scan.points.size(), 0.0f)};
  parallel_for(
      scan.points.size(),
      [&](std::size_t i) {
        const auto& p = scan.points[i];
        const double x = scan.origin.x() + p[0], y = scan.origin.y() + p[1], z = scan.origin.z() + p[2];
        const double length = x * x + y * y + z * z;
        if (!std::isfinite(length) || length == 0) return;
        const double horizontal = std::hypot(x, y);
        angles.azimuth_rad[i] = std::atan2(y, x);
        angles.horizontal_m[i] = static_cast<float>(horizontal);
        angles.elevation_rad[i] = std::atan2(z, horizontal);
      },
      4096);
  return angles;
}

void sort_by_elevation(const SampleAngles& angles, std::span<std::uint32_t> samples) {
  std::vector<std::pair<double, std::uint32_t>> keys;
  keys.reserve(samples.size());
  for (const std::uint32_t i : samples) keys.emplace_back(-angles.elevation_rad[i], i);
  std::sort(keys.begin(), keys.end());
  for (std::size_t k = 0; k < keys.size(); ++k) samples[k] = keys[k].second;
}

Sweeps sweeps_of_acquisition(const SampleAngles& angles) {
  Sweeps sweeps{returns(angles), {}, {}};
  const auto& order = sweeps.samples;
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
  if (!cut(angles, rule, sweeps)) return {};
  for (int pass = 0; pass < 2; ++pass) {
    const double step = azimuth_step(sweeps);
    if (step <= 0) break;
    rule.widest_azimuth_rad = kSidewaysShare * step;
    if (!cut(angles, rule, sweeps)) return {};
  }
  return are_columns(angles, sweeps, azimuth_step(sweeps)) ? sweeps : Sweeps{};
}

Sweeps sweeps_of_azimuth(const SampleAngles& angles) {
  const LevelSamples level = level_by_azimuth(angles);
  const std::size_t count = level.samples.size();
  if (count < kMinimumColumns * kMinimumColumns) return {};
  const auto gap_before = [&](std::size_t k) {  // k > 0
    return angles.azimuth_rad[level.samples[k]] - angles.azimuth_rad[level.samples[k - 1]];
  };
  const double threshold = gap_between_columns(gap_before, count);
  if (threshold <= 0) return {};

  Sweeps sweeps{{}, {0}, {}};
  std::vector<double> first{angles.azimuth_rad[level.samples[0]]};  // azimuth of a column's first
  for (std::size_t k = 1; k < count; ++k)
    if (gap_before(k) > threshold) {
      sweeps.begin.push_back(k);
      first.push_back(angles.azimuth_rad[level.samples[k]]);
    }
  sweeps.begin.push_back(count);

  std::vector<std::vector<std::uint32_t>> steep(first.size());
  for (const std::uint32_t sample : level.steep) {
    const double azimuth = angles.azimuth_rad[sample];
    const auto after = std::lower_bound(first.begin(), first.end(), azimuth);
    std::size_t c = static_cast<std::size_t>(after - first.begin()) % first.size();
    const std::size_t previous = (c + first.size() - 1) % first.size();
    if (std::abs(wrapped(azimuth - first[previous])) < std::abs(wrapped(azimuth - first[c]))) c = previous;
    steep[c].push_back(sample);
  }
  sweeps.samples.reserve(count + level.steep.size());
  for (std::size_t c = 0; c < first.size(); ++c) {
    const auto at = [&](std::size_t k) { return level.samples.begin() + static_cast<std::ptrdiff_t>(k); };
    const std::size_t begin = std::exchange(sweeps.begin[c], sweeps.samples.size());
    sweeps.samples.insert(sweeps.samples.end(), at(begin), at(sweeps.begin[c + 1]));
    sweeps.samples.insert(sweeps.samples.end(), steep[c].begin(), steep[c].end());
  }
  sweeps.begin.back() = sweeps.samples.size();
  add_azimuths(angles, sweeps);
  return sweeps;
}

}  // namespace hybrid::stages
