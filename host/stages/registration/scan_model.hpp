#pragma once
#include "geometry/polygon_model.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// A scan's superclusters as a model that other scans can be aligned to: their contour polygons, scan frame,
// fronts towards the scanner; "supercluster 12" and so on. Contours are straightened to a few sample
// spacings, as small detail only costs time here. What cannot be triangulated is left out. Needs
// trace_contours().
PolygonModel model_of_scan(const RangeImage& image, const PlaneSegmentation& segmentation);

}  // namespace hybrid::stages
