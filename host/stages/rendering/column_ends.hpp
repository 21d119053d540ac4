#pragma once
#include <vector>

#include "geometry/polygon_model.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

// A copy of a polygon of a column's base or head.
struct ColumnEnd {
  std::size_t scan = 0;
  std::uint32_t cylinder = 0;  // id in that scan
  PolygonModel polygon;        // one face, world frame, front side outwards
};

// The sides of plinths and abaci that no scan has seen. What carries a column and what it carries is square,
// octagonal or round about the column's axis: what is square is there whole (column_squares.hpp), or, where
// none of it was seen, as at the nearest column of the same design; and a polygon seen there (of `contours`,
// world frame, near an end of a column that a scan shows and no wider than it may be) is there a quarter, a
// half and three quarters of a turn on, too; both where a fair part of it is in no scan's sight and hardly
// any of it is seen to be empty. Each column once, of the first scan that shows it.
std::vector<ColumnEnd> column_ends(const ScanSight& sight, const PolygonModel& contours);

}  // namespace hybrid::stages
