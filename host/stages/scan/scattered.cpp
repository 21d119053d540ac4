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

// Bands and bins are as many as the density says: where samples lie close together, as seen from where the
// scanner did not stand, far more than samples. Beyond this they are sorted, not counted.
constexpr double kMostCounted = 1 << 14;

// Where a share of the whole, 0 to 1, lies among `parts` of it.
double part_of(double share, double parts) {
  return std::clamp(std::floor(share * parts), 0.0, parts - 1);
}

// Bins about `side` high and wide: bands of elevation, each with its own number of bins.
struct Bins {
  const SampleAngles& angles;
  double side, bands = std::max(1.0, std::round(std::numbers::pi / side));

  double top_of(double band) const { return std::numbers::pi * (0.5 - band / bands); }
  double in_band(double band) const {
    return std::max(1.0, std::round(kTurn * std::cos(top_of(band + 0.5)) / side));
  }
  double steradian_of(double band) const {
    return kTurn / in_band(band) * (std::sin(top_of(band)) - std::sin(top_of(band + 1)));
  }
  double band_of(std::size_t i) const {
    return part_of(0.5 - angles.elevation_rad[i] / std::numbers::pi, bands);
  }
  double bin_of(std::size_t i, double bins) const {
    return part_of(angles.azimuth_rad[i] / kTurn + 0.5, bins);
  }
};

// Of a bin with samples.
struct Counted {
  double density;  // per steradian
  std::size_t samples;
  auto operator<=>(const Counted&) const = default;
};

std::vector<Counted> count_by_band(const Bins& bins) {
  std::vector<double> in_band;
  for (double band = 0; band < bins.bands; ++band) in_band.push_back(bins.in_band(band));
  const auto band_of = [&](std::size_t i) { return static_cast<std::uint32_t>(bins.band_of(i)); };
  const ItemGroups bin_by_band = group_items(
      bins.angles.azimuth_rad.size(), in_band.size(),
      [&](std::size_t i) { return std::isnan(bins.angles.elevation_rad[i]) ? kNoGroup : band_of(i); },
      [&](std::size_t i) { return static_cast<std::uint32_t>(bins.bin_of(i, in_band[band_of(i)])); });
  std::vector<std::vector<Counted>> of_band(in_band.size());
  parallel_for(in_band.size(), [&](std::size_t band) {
    const std::size_t begin = bin_by_band.begin[band], end = bin_by_band.begin[band + 1];
    if (begin == end) return;
    std::vector<std::uint32_t> samples(static_cast<std::size_t>(in_band[band]));
    for (std::size_t k = begin; k < end; ++k) ++samples[bin_by_band.values[k]];
    const double steradian = bins.steradian_of(static_cast<double>(band));
    for (const std::uint32_t in_bin : samples)
      if (in_bin > 0) of_band[band].push_back({in_bin / steradian, in_bin});
  });
  std::vector<Counted> counted;
  for (const auto& of_one : of_band) counted.insert(counted.end(), of_one.begin(), of_one.end());
  return counted;
}

std::vector<Counted> count_by_sorting(const Bins& bins) {
  std::vector<std::pair<double, double>> places;  // band and bin
  for (std::size_t i = 0; i < bins.angles.azimuth_rad.size(); ++i)
    if (!std::isnan(bins.angles.elevation_rad[i])) {
      const double band = bins.band_of(i);
      places.emplace_back(band, bins.bin_of(i, bins.in_band(band)));
    }
  tbb::parallel_sort(places);
  std::vector<Counted> counted;
  for (std::size_t begin = 0, end; begin < places.size(); begin = end) {
    end = begin;
    while (end < places.size() && places[end] == places[begin]) ++end;
    counted.push_back(
        {static_cast<double>(end - begin) / bins.steradian_of(places[begin].first), end - begin});
  }
  return counted;
}

// Samples per steradian around the median sample.
double median_density(const Bins& bins) {
  auto counted = bins.bands <= kMostCounted ? count_by_band(bins) : count_by_sorting(bins);
  tbb::parallel_sort(counted);
  std::size_t all = 0, passed = 0;
  for (const Counted& bin : counted) all += bin.samples;
  for (const Counted& bin : counted) {
    passed += bin.samples;
    if (2 * passed >= all) return bin.density;
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
    density = median_density({angles, std::sqrt(kPerBin / density)});

  const double bins = std::max(1.0, std::round(kTurn * std::sqrt(density)));
  result.step_rad = kTurn / bins;
  const auto bin_of = [&](std::uint32_t i) { return part_of(angles.azimuth_rad[i] / kTurn + 0.5, bins); };
  const double per_group = std::ceil(bins / kMostCounted);
  ItemGroups groups = group_items(
      angles.azimuth_rad.size(), static_cast<std::size_t>(std::ceil(bins / per_group)),
      [&](std::size_t i) {
        const auto sample = static_cast<std::uint32_t>(i);
        return std::isnan(angles.elevation_rad[i]) ? kNoGroup
                                                   : static_cast<std::uint32_t>(bin_of(sample) / per_group);
      },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  std::vector<std::vector<std::size_t>> first_of_bin(groups.begin.size() - 1);
  parallel_for(first_of_bin.size(), [&](std::size_t group) {
    const auto at = [&](std::size_t k) { return groups.values.begin() + static_cast<std::ptrdiff_t>(k); };
    const std::size_t begin = groups.begin[group], end = groups.begin[group + 1];
    if (per_group > 1)
      std::stable_sort(at(begin), at(end), [&](auto a, auto b) { return bin_of(a) < bin_of(b); });
    for (std::size_t k = begin; k < end; ++k)
      if (k == begin || (per_group > 1 && bin_of(groups.values[k]) != bin_of(groups.values[k - 1])))
        first_of_bin[group].push_back(k);
  });
  for (const auto& of_group : first_of_bin)
    for (const std::size_t k : of_group) {
      result.sweeps.azimuth_rad.push_back((bin_of(groups.values[k]) + 0.5) * result.step_rad -
                                          std::numbers::pi);
      result.sweeps.begin.push_back(k);
    }
  result.sweeps.begin.push_back(groups.values.size());
  result.sweeps.samples = std::move(groups.values);
  return result;
}

}  // namespace hybrid::stages
