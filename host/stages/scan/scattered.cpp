#include "stages/scan/scattered.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/group_items.hpp"
#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr double kPerBin = 16;  // samples of a bin in which they are counted
constexpr int kRounds = 4;      // each makes the bins fit the density that the one before found

// Where an azimuth lies among `bins` that part the turn.
std::uint32_t bin_of(double azimuth_rad, double bins) {
  return static_cast<std::uint32_t>(
      std::clamp(std::floor((azimuth_rad / kTurn + 0.5) * bins), 0.0, bins - 1));
}

// Samples per steradian around the median sample, counted in bins about `side` high and wide.
double median_density(const SampleAngles& angles, double side) {
  struct Counted {
    double density;
    std::uint32_t samples;
    auto operator<=>(const Counted&) const = default;
  };
  const double bands = std::max(1.0, std::round(std::numbers::pi / side));
  const auto top_of = [&](double band) { return std::numbers::pi * (0.5 - band / bands); };
  std::vector<double> bins(static_cast<std::size_t>(bands));  // of each band
  for (std::size_t band = 0; band < bins.size(); ++band)
    bins[band] = std::max(1.0, std::round(kTurn * std::cos(top_of(static_cast<double>(band) + 0.5)) / side));
  const auto band_of = [&](std::size_t i) {
    return static_cast<std::uint32_t>(
        std::clamp(std::floor((0.5 - angles.elevation_rad[i] / std::numbers::pi) * bands), 0.0, bands - 1));
  };
  const ItemGroups bin_by_band = group_items(
      angles.azimuth_rad.size(), bins.size(),
      [&](std::size_t i) { return std::isnan(angles.elevation_rad[i]) ? kNoGroup : band_of(i); },
      [&](std::size_t i) { return bin_of(angles.azimuth_rad[i], bins[band_of(i)]); });

  std::vector<std::vector<Counted>> in_band(bins.size());
  parallel_for(bins.size(), [&](std::size_t band) {
    const std::size_t begin = bin_by_band.begin[band], end = bin_by_band.begin[band + 1];
    if (begin == end) return;
    std::vector<std::uint32_t> samples(static_cast<std::size_t>(bins[band]));
    for (std::size_t k = begin; k < end; ++k) ++samples[bin_by_band.values[k]];
    const auto at = static_cast<double>(band);
    const double steradian = kTurn / bins[band] * (std::sin(top_of(at)) - std::sin(top_of(at + 1)));
    for (const std::uint32_t in_bin : samples)
      if (in_bin > 0) in_band[band].push_back({in_bin / steradian, in_bin});
  });
  std::vector<Counted> counted;
  for (const auto& of_band : in_band) counted.insert(counted.end(), of_band.begin(), of_band.end());
  tbb::parallel_sort(counted);
  std::size_t passed = 0;
  for (const Counted& bin : counted) {
    passed += bin.samples;
    if (2 * passed >= bin_by_band.values.size()) return bin.density;
  }
  return 0;
}

}  // namespace

ScatteredSweeps scatter_sweeps(const SampleAngles& angles) {
  ScatteredSweeps result;
  double count = 0;
  for (const double elevation : angles.elevation_rad) count += !std::isnan(elevation);
  if (count < kPerBin) return result;
  double density = count / (2 * kTurn);
  for (int round = 0; round < kRounds; ++round)
    density = median_density(angles, std::sqrt(kPerBin / density));

  const double bins = std::max(1.0, std::round(kTurn * std::sqrt(density)));
  result.step_rad = kTurn / bins;
  ItemGroups by_bin = group_items(
      angles.azimuth_rad.size(), static_cast<std::size_t>(bins),
      [&](std::size_t i) {
        return std::isnan(angles.elevation_rad[i]) ? kNoGroup : bin_of(angles.azimuth_rad[i], bins);
      },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  for (std::size_t bin = 0; bin + 1 < by_bin.begin.size(); ++bin) {
    if (by_bin.begin[bin] == by_bin.begin[bin + 1]) continue;
    result.sweeps.azimuth_rad.push_back((static_cast<double>(bin) + 0.5) * result.step_rad -
                                        std::numbers::pi);
    result.sweeps.begin.push_back(by_bin.begin[bin]);
  }
  result.sweeps.begin.push_back(by_bin.values.size());
  result.sweeps.samples = std::move(by_bin.values);
  return result;
}

}  // namespace hybrid::stages
