#pragma once
#include "geometry/image.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/contours/intersections.hpp"

namespace hybrid::stages {

inline constexpr std::size_t kManySamples = 2'000'000;  // say what the percentiles of a scan are

// Figure 2(b) of the paper, one RGB pixel per node: a pastel colour per supercluster (by id, neighbouring ids
// far apart in hue), orange = on a column or pipe, brown = on a barrel vault, dark blue = locally planar but
// too small, dark green = non-planar (also outliers in a supercluster's square), black = undersampled or no
// return.
Image8 class_picture(const RangeImage& image, const PlaneSegmentation& segmentation);

// Draws the lines in which planes meet on it: red in corners, blue on edges that stand out.
void draw_intersections(const RangeImage& image, const std::vector<Intersection>& intersections,
                        Image8& picture);

// Figure 2(a), one grey pixel per node: near bright, far dark, by the logarithm of the range between its 1st
// and 99th percentile; black = no return.
Image8 range_picture(const RangeImage& image);

}  // namespace hybrid::stages
