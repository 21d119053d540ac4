#pragma once
#include "stages/rendering/curtains.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

inline constexpr int kColumnSides =
    24;  // of what stands for a column; inscribed, by 1 % of the radius at most

inline constexpr double kColumnSlice_m = 0.1;  // of its length, that a scan may have seen to be empty

// The place on a cylinder's surface, or so far off it, along its axis and around it; its own frame.
Vec3 on_cylinder(const Cylinder& cylinder, double along_m, double turn_rad, double off_m = 0);

// A quadrilateral of a column's surface, world frame, front side outwards.
struct ColumnBack {
  std::size_t scan = 0;
  std::uint32_t cylinder = 0;  // id in that scan
  Curtain corners;
};

// The parts of columns and pipes that no scan has seen: neither their surface, nor that the place is empty. A
// column is known to be round from the part that was seen, so its back is known, too. Strips along the axis,
// in slices of 10 cm joined where they follow each other. Beyond its ends the same of its base and its head,
// as far as all that scans show there is round, slice by slice, two radii at most; what is hidden farther on
// is as at another column of the same design (is_alike) at that height. In the order of scans and cylinders.
std::vector<ColumnBack> column_backs(const ScanSight& sight);

}  // namespace hybrid::stages
