#pragma once
#include <vector>

#include "stages/rendering/flat_polygon.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

// Whether a polygon that something suggests (world frame) may be there: a fair part of it is in no scan's
// sight and on none of the polygons `others`, and hardly any of it is seen to be empty. Asked at places 3 cm
// apart, fewer on large ones.
bool may_be_there(const ScanSight& sight, const FlatPolygon& polygon, const std::vector<FlatPolygon>& others);

}  // namespace hybrid::stages
