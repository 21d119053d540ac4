#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/contours/intersections.hpp"
#include "stages/contours/simple_rings.hpp"

namespace hybrid::stages {

// How far apart samples are at a point along a direction, times the radians between them as the scanner, at
// the origin, sees it; at most three times the point's range.
double step_across(const Vec3& point, const Vec3& out);

// The rings of a supercluster's contours, whose vertices are its outermost samples, moved out to where its
// plane ends: anywhere before the next sample, on the mean half a step of the scan's grid farther. Sides that
// lie on one of the plane's intersections (those of `intersections` that name it) are known and stay.
// `steps`: how far, in steps, as the scanner sees it; on the plane at most three times as far. Rings that
// would meet themselves or each other stay as they are, and so do holes that would close.
std::vector<FlatRing> widened_rings(const RangeImage& image, const Supercluster& supercluster,
                                    const std::vector<Intersection>& intersections, double steps,
                                    const std::vector<FlatRing>& rings);

}  // namespace hybrid::stages
