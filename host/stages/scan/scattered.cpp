#include "stages/scan/scattered.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr double kPerBin = 16;  // samples of a bin in which they are counted
constexpr int kRounds = 4;      // each makes the bins fit the density that the one before found

// Samples per steradian around the median sample, counted in bins about `side` high and wide.
double median_density(const SampleAngles& angles, double side) {
  struct Counted {
    double density;
    std::size_t samples;
  };
  const double bands = std::max(1.0, std::round(std::numbers::pi / side));
  const auto top_of = [&](double band) { return std::numbers::pi * (0.5 - band / bands); };
  const auto bins_of = [&](double band) {
    return std::max(1.0, std::round(kTurn * std::cos(top_of(band + 0.5)) / side));
  };
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < angles.azimuth_rad.size(); ++i) {
    if (std::isnan(angles.elevation_rad[i])) continue;
    const double band =
        std::clamp(std::floor((0.5 - angles.elevation_rad[i] / std::numbers::pi) * bands), 0.0, bands - 1);
    const double bins = bins_of(band);
    const double bin = std::clamp(std::floor((angles.azimuth_rad[i] / kTurn + 0.5) * bins), 0.0, bins - 1);
    keys.push_back(static_cast<std::uint64_t>(band) << 32 | static_cast<std::uint64_t>(bin));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Counted> counted;
  for (std::size_t begin = 0, end; begin < keys.size(); begin = end) {
    end = begin;
    while (end < keys.size() && keys[end] == keys[begin]) ++end;
    const auto band = static_cast<double>(keys[begin] >> 32);
    const double steradian = kTurn / bins_of(band) * (std::sin(top_of(band)) - std::sin(top_of(band + 1)));
    counted.push_back({static_cast<double>(end - begin) / steradian, end - begin});
  }
  std::sort(counted.begin(), counted.end(),
            [](const Counted& a, const Counted& b) { return a.density < b.density; });
  std::size_t passed = 0;
  for (const Counted& bin : counted) {
    passed += bin.samples;
    if (2 * passed >= keys.size()) return bin.density;
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
  std::vector<std::pair<std::uint32_t, std::uint32_t>> bin_and_sample;
  for (std::size_t i = 0; i < angles.azimuth_rad.size(); ++i)
    if (!std::isnan(angles.elevation_rad[i])) {
      const double bin = std::clamp(std::floor((angles.azimuth_rad[i] / kTurn + 0.5) * bins), 0.0, bins - 1);
      bin_and_sample.emplace_back(static_cast<std::uint32_t>(bin), static_cast<std::uint32_t>(i));
    }
  std::sort(bin_and_sample.begin(), bin_and_sample.end());
  for (const auto& [bin, sample] : bin_and_sample) {
    const double middle = (bin + 0.5) * result.step_rad - std::numbers::pi;
    if (result.sweeps.azimuth_rad.empty() || result.sweeps.azimuth_rad.back() != middle) {
      result.sweeps.azimuth_rad.push_back(middle);
      result.sweeps.begin.push_back(result.sweeps.samples.size());
    }
    result.sweeps.samples.push_back(sample);
  }
  result.sweeps.begin.push_back(result.sweeps.samples.size());
  return result;
}

}  // namespace hybrid::stages
