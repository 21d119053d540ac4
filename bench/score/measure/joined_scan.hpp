#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "score/read/scan_result.hpp"
#include "score/read/scene_truth.hpp"

namespace score {

// What the truth and a result say of one scan, per node of the result's grid (METHOD: measured samples only,
// joined by their index in the input).
struct JoinedScan {
  int rows = 0, cols = 0;
  bool wraps = false;
  std::vector<std::uint32_t> plane;  // true plane; 0 = none
  std::vector<std::uint8_t> kind;    // kNotMeasured where the grid holds no measured sample
  std::vector<std::uint32_t> label;  // the result's; 0 = none
  std::int64_t input_samples = 0, measured = 0;
  std::int64_t min_samples = 100;                    // planes with fewer are not counted
  std::map<std::uint32_t, std::int64_t> plane_size;  // measured planar samples per true plane

  // A planar sample of a plane that counts.
  bool counts(std::size_t i) const {
    return kind[i] == kPlanar && plane[i] != 0 && plane_size.at(plane[i]) >= min_samples;
  }
};

// Throws InputError when a source is no sample of the truth; `name` is the file to blame.
JoinedScan join(const LabelledGrid& grid, const TrueSamples& truth, std::int64_t min_samples,
                const std::string& name);

// Throws InputError unless the measured ranges are those of this truth: another seed's or scene's results
// would get numbers that look bad and mean nothing.
void check_same_scan(const LabelledGrid& grid, const TrueSamples& truth, const std::string& name,
                     const std::string& truth_name);
// Median difference of measured and true ranges, metres; infinite when a source is no sample of this truth.
double range_disagreement(const LabelledGrid& grid, const TrueSamples& truth);
inline constexpr double kSameScanM = 0.05;

}  // namespace score
