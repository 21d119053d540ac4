#pragma once
#include <string>
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

struct SlideOptions {
  ScanIcpOptions icp;
  double reach_m = 0.3;  // how far off along the direction the pose may be
  // Of the scan's area, areas times the squared component of their normals along the direction that must lie
  // on surfaces of others: of the fronts of churches 0.002 and more does.
  double least_share = 0.001;
  // What of it may do so at other places within reach, as a share: right places have 0.25 at most, best ones
  // of reaches without the right one 0.1 to 1 and more.
  double most_elsewhere = 0.5;
  double most_through = 0.25;  // share seen through there: of right places 0.23 at most, of wrong ones 0.9
};

// Where along a direction a scan lies on others.
struct SlideOnScans {
  bool accepted = false;
  std::string reason;  // why not, in words
  Vec3 direction = Vec3::UnitX();
  double shift_m = 0, sigma_m = 0;
  double on_m2 = 0, through_m2 = 0;  // areas times the squared component of their normals along it
  double elsewhere = 0;              // share of on_m2 that the best other place has
  std::vector<double> on_other_m2;   // of on_m2, by scan placed
  double seen_through() const { return on_m2 + through_m2 > 0 ? through_m2 / (on_m2 + through_m2) : 0; }
};

// METHOD 7: a scan that the model leaves free to slide along one direction, as a front that is one wall, is
// held there by what little other scans have seen of it, as through a door: of all places within reach the
// one where most of the planar samples that bear on a shift lie on surfaces of the others, and from there
// robust ICP along the line alone. Refused where hardly anything bears on it, where another place fits as
// well, or where the scans see through it. `direction`: world, unit.
SlideOnScans slide_on_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                            const Pose& world_from_scan, const Vec3& direction,
                            const SlideOptions& options = {});

}  // namespace hybrid::stages
