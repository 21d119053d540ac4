#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::stages {

// Directions of a scan's samples as seen from the scanner (scan frame), one per input sample; NaN where the
// sample is no return (not finite, or at the origin).
struct SampleAngles {
  const Scan& scan;                   // whose they are
  std::vector<double> azimuth_rad;    // (-pi, pi]
  std::vector<double> elevation_rad;  // [-pi/2, pi/2]
  std::vector<float> horizontal_m;    // distance from the vertical axis: what azimuth noise is relative to
};
SampleAngles sample_angles(const Scan& scan);

// Samples taken in one sweep of the mirror (or found at one azimuth), one sweep after the other.
struct Sweeps {
  std::vector<std::uint32_t> samples;  // indices of returns, each exactly once
  std::vector<std::size_t> begin;      // sweep s: samples[begin[s] .. begin[s + 1]); one more than sweeps
  std::vector<double> azimuth_rad;     // per sweep, (-pi, pi]: mean direction weighted by cos(elevation)
  std::size_t count() const { return azimuth_rad.size(); }
};

// For sorting a sweep's samples: by descending elevation, ties by index.
void sort_by_elevation(const SampleAngles& angles, std::span<std::uint32_t> samples);

// Cuts the samples in file order where the elevation turns back (a flyback, or the other half of a sweep to
// and fro) or the azimuth jumps by a good part of a column. No sweeps when that yields no columns: samples
// not in acquisition order, or by rows.
Sweeps sweeps_of_acquisition(const SampleAngles& angles);

// For clouds in any order: sorts by azimuth and cuts at the wide gaps, where the gaps fall into two kinds:
// within a column and between columns. No sweeps when they do not.
Sweeps sweeps_of_azimuth(const SampleAngles& angles);

// The usual one of positive `differences` that also hold many near zero (repeated columns, several returns)
// and some multiples (dropouts): the median of those above a quarter of their 90th percentile. 0 when none
// is positive.
double typical_step(std::vector<double> differences);

// `angle` moved by whole turns into [-pi, pi).
double wrapped(double angle);

}  // namespace hybrid::stages
