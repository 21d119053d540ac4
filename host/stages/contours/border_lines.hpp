#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/contours/simple_rings.hpp"

namespace hybrid::stages {

// The rings of a supercluster's contours (flat_rings: some of the contours' points, in their order) with a
// straight line by least squares through all of a contour's points along each straight border. Such points
// are a plane's last samples before its border, anywhere within one step of the scan's grid: those of them
// that a ring keeps as vertices are the outermost and the innermost ones, and its border would go up and down
// by a step. Adjacent sides become one where the points of both lie within `most_steps` of one line and on
// the mean (rms) within `rms_steps`, steps as the scanner sees them across that line; short ones stay as they
// are, and so do long sides without points between, which lie on an intersection with another plane. Corners
// are where lines meet. Rings that would meet themselves or each other stay as they are.
std::vector<FlatRing> with_border_lines(const RangeImage& image, const Supercluster& supercluster,
                                        const std::vector<FlatRing>& rings, double rms_steps,
                                        double most_steps);

}  // namespace hybrid::stages
