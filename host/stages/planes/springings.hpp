#pragma once
#include "geometry/superclusters.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::stages {

// A vault or an arch leaves its wall along a tangent, its springing line: its first decimetres are within the
// noise of the wall's plane, sample by sample. Where a cylinder of the segmentation that is seen from inside
// touches a plane, the plane ends there and the cylinder goes on, samples of the plane that lie beyond the
// line and on the cylinder lose their label and are the cylinder's. Planes that lost many are fitted again,
// all that lost some are measured again; ids stay.
void trim_springings(const RangeImage& image, const RangeNoise& noise, const SuperclusterOptions& options,
                     PlaneSegmentation& segmentation);

}  // namespace hybrid::stages
