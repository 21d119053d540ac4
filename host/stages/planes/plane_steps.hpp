#pragma once
#include "geometry/range_image.hpp"
#include "stages/planes/sample_labels.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// Of the waviness: less is the wall's own, parallel planes that lie farther apart are two.
inline constexpr double kLeastOfWaviness = 0.4;

struct StepLimits {
  std::int64_t least_samples = 48;  // of a part
  double waviness_m = 0.005;        // of walls: steps of less than two fifths are theirs
};

struct StepChanges {
  std::vector<std::uint32_t> labels;  // whose samples changed
  double excess = 1;  // by which means of windows scatter more than the noise of their samples explains
};

// Splits planes where they step: a rail 2 mm proud of its panel is within the noise of each of its samples,
// and far outside that of their mean. Windows whose mean leaves the plane propose a part, and of small
// planes, which go through the middle of both, lines (step_lines.hpp) before windows do; StepSharing decides
// what it is. Parts become regions (small, with a plane and the squares in which they lie) and take their
// samples; those of one plane at one height are one region. Strips that are the beginning of a curved surface
// lose their label. What windows of a whole scan commonly leave their planes by (correlated noise, waviness)
// counts as noise. A plane that would lose three fifths of its samples to parts is banded (by quantised
// ranges, say) and stays whole.
StepChanges split_steps(const RangeImage& image, const SquareGrid& grid, int square, const RangeNoise& noise,
                        const StepLimits& limits, std::vector<std::uint32_t>& labels,
                        std::vector<Plane>& planes, PlaneRegions& regions);

}  // namespace hybrid::stages
