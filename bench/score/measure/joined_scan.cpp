#include "score/measure/joined_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "score/error.hpp"

namespace score {

JoinedScan join(const LabelledGrid& grid, const TrueSamples& truth, std::int64_t min_samples,
                const std::string& name) {
  JoinedScan scan;
  scan.rows = grid.rows;
  scan.cols = grid.cols;
  scan.wraps = grid.wraps;
  scan.min_samples = min_samples;
  scan.input_samples = static_cast<std::int64_t>(truth.plane.size());
  scan.plane.assign(grid.source.size(), 0);
  scan.kind.assign(grid.source.size(), kNotMeasured);
  scan.label = grid.label;
  for (std::size_t i = 0; i < grid.source.size(); ++i) {
    const std::uint32_t source = grid.source[i];
    if (source == kNoSource) continue;
    if (source >= truth.plane.size())
      bad_input(
          "{}: expected sources below the truth's {} samples, found {}; score the results with their own "
          "truth",
          name, truth.plane.size(), source);
    ++scan.measured;
    scan.plane[i] = truth.plane[source];
    scan.kind[i] = truth.kind[source];
    if (scan.kind[i] == kPlanar && scan.plane[i] != 0) ++scan.plane_size[scan.plane[i]];
  }
  return scan;
}

double range_disagreement(const LabelledGrid& grid, const TrueSamples& truth) {
  std::vector<float> off;
  for (std::size_t i = 0; i < grid.source.size(); ++i) {
    if (grid.source[i] == kNoSource) continue;
    if (grid.source[i] >= truth.range_m.size()) return std::numeric_limits<double>::infinity();
    const float difference = std::abs(grid.range_m[i] - truth.range_m[grid.source[i]]);
    if (std::isfinite(difference)) off.push_back(difference);
  }
  if (off.empty()) return 0;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return *middle;
}

void check_same_scan(const LabelledGrid& grid, const TrueSamples& truth, const std::string& name,
                     const std::string& truth_name) {
  const double off_m = range_disagreement(grid, truth);
  if (off_m <= kSameScanM) return;
  bad_input(
      "{}: expected the scan that {} knows, found another scene's or seed's ({}); score the results with "
      "their own "
      "truth.json",
      name, truth_name,
      std::isfinite(off_m) ? fmt::format("half of the ranges differ by more than {:.3f} m", off_m)
                           : std::string("it names samples that the truth does not have"));
}

}  // namespace score
