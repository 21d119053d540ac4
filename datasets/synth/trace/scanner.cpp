// A time-of-flight scanner of about 2004 (Lamond and Watson, section 2.1): a rotating mirror sweeps the beam
// up one column while the housing turns by even steps in azimuth; where a column starts, and so how many
// samples it holds, varies.
#include "trace/scanner.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/angles.hpp"
#include "geometry/random.hpp"
#include "trace/beam.hpp"

namespace synth {
namespace {

constexpr double kLowestRad = -60 * kDegree;  // the tripod hides what is below
constexpr double kHighestRad = 89.5 * kDegree;
constexpr std::size_t kSamplesAtATime = 1 << 20;

struct Sweep {
  const Beam& beam;
  const ScannerPose& pose;
  const Options& options;
  std::uint64_t scan_index;

  std::vector<Sample> column(int column) const {
    const ScannerModel& model = options.scanner;
    const int columns = options.preset.scan_columns, rows = options.preset.scan_rows;
    Random random(options.seed, purpose::scan_column + 100 * (scan_index + 1),
                  static_cast<std::uint64_t>(column));
    Random chance(options.seed, purpose::optics + 100 * (scan_index + 1), static_cast<std::uint64_t>(column));
    const double step = row_step_rad(options.preset);
    const double azimuth = 2 * std::numbers::pi * (column + 0.5 + 0.004 * random.normal()) / columns;
    double start = kLowestRad + step * random.uniform(0, 2.5),
           end = kHighestRad - step * random.uniform(0, 3);
    if (pose.grid) {
      start = kLowestRad + step / 2;
      end = std::numeric_limits<double>::infinity();
    }
    const Eigen::Matrix3d rotation = pose.world_from_scan.rotation();
    const int first_row = static_cast<int>(std::floor((start - kLowestRad) / step));
    std::vector<Sample> samples;
    for (int k = 0;; ++k) {
      const double jitter = std::clamp(0.04 * random.normal(), -0.2, 0.2);
      const double elevation = start + step * (k + jitter);
      // Every sample draws the same count whatever it hits, so one change in the world leaves the others'
      // noise alone.
      const double range_noise = random.normal(), intensity_noise = 0.012 * random.normal();
      const bool dropped = random.uniform() < model.dropout_share;
      Random optics(chance.bits(), purpose::optics);
      if (elevation > end || (pose.grid && k == rows)) return samples;
      const Vec3 in_scan(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                         std::sin(elevation));
      const auto hit = dropped ? std::nullopt : beam.measure(rotation * in_scan, optics);
      if (!hit) continue;
      const double spread = model.incidence_gain * (kBeamRadiusM + kBeamSpreadRad * hit->range_m) *
                            std::min(8.0, hit->tan_incidence);
      const double sigma = model.noise_m + model.noise_per_m * hit->range_m + spread;
      const double fading = 1.0 / (1.0 + 0.01 * hit->range_m * hit->range_m);
      samples.push_back(
          {((hit->range_m + sigma * range_noise) * in_scan).cast<float>(),
           static_cast<float>(std::clamp(hit->reflectance * fading * 1.3 + intensity_noise, 0.0, 1.0)),
           hit->plane_id, static_cast<float>(hit->true_range_m), hit->kind, first_row + k});
    }
  }
};

void count(ScanCounts& counts, const std::vector<Sample>& column) {
  counts.shortest_column =
      counts.columns == 0 ? column.size() : std::min(counts.shortest_column, column.size());
  counts.longest_column = std::max(counts.longest_column, column.size());
  ++counts.columns;
  counts.returns += column.size();
  for (const Sample& sample : column) ++counts.returns_of_kind[static_cast<std::size_t>(sample.kind)];
}

}  // namespace

Sample no_return() {
  return {Eigen::Vector3f::Zero(), 0, 0, std::numeric_limits<float>::quiet_NaN(), SampleKind::planar};
}

int grid_rows(const ScannerPose& pose, const Preset& preset) {
  return preset.scan_rows + (pose.grid ? 0 : 1);
}

double row_step_rad(const Preset& preset) {
  return (kHighestRad - kLowestRad) / preset.scan_rows;
}

double lowest_row_rad(const Preset& preset) {
  return kLowestRad + row_step_rad(preset) / 2;
}

double column_step_rad(const Preset& preset) {
  return 2 * std::numbers::pi / preset.scan_columns;
}

double first_column_rad(const Preset& preset) {
  return column_step_rad(preset) / 2;
}

ScanCounts simulate_scan(const World& world, const Tracer& tracer, const ScannerPose& pose,
                         const Options& options, std::uint64_t scan_index,
                         const std::function<void(const std::vector<Sample>&)>& take) {
  const Beam beam{world, tracer, pose.world_from_scan.translation(), options.scanner.optics};
  const Sweep sweep{beam, pose, options, scan_index};
  const int at_a_time =
      std::max(16, static_cast<int>(kSamplesAtATime / static_cast<std::size_t>(options.preset.scan_rows)));
  ScanCounts counts;
  counts.pose = pose;
  for (int first = 0; first < options.preset.scan_columns; first += at_a_time) {
    const int last = std::min(options.preset.scan_columns, first + at_a_time);
    std::vector<std::vector<Sample>> columns(static_cast<std::size_t>(last - first));
    tbb::parallel_for(first, last,
                      [&](int k) { columns[static_cast<std::size_t>(k - first)] = sweep.column(k); });
    for (const auto& column : columns) {
      take(column);
      count(counts, column);
    }
  }
  return counts;
}

}  // namespace synth
