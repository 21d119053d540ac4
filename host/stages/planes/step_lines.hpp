#pragma once
#include "stages/planes/step_sharing.hpp"

namespace hybrid::stages {

// The samples of a plane: how many, and where on the image.
struct PlaneExtent {
  std::uint32_t label = 0;
  std::int64_t samples = 0;
  int top = 0, left = 0, bottom = 0, right = 0;  // the last two exclusive
};

// Small planes that may step along a straight line: a rail on its panel of which a scan has so few samples
// that no window of them leaves the plane, which goes through the middle of both. Of all straight lines
// across such a plane the one is taken along which level, slopes and a step explain the heights best (least
// squares; the likelihood ratio against level and slopes alone); the part is the side with fewer samples. At
// most one proposal a plane, in their order; `excess`: as StepSharing's. None where a bend explains them
// better, nor of a plane scattered over much of the image. `least`: samples of the smallest part.
std::vector<StepProposal> propose_by_lines(const RangeImage& image, const RangeNoise& noise,
                                           const std::vector<std::uint32_t>& labels,
                                           const std::vector<Plane>& plane_of_label,
                                           const std::vector<PlaneExtent>& extents, double excess,
                                           std::int64_t least);

}  // namespace hybrid::stages
