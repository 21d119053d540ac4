#pragma once
#include <functional>
#include <vector>

#include "stages/registration/icp.hpp"
#include "stages/registration/icp_scan.hpp"

namespace hybrid::stages {

struct ScanIcpOptions {
  double gate_m = 1;           // between pairs at the start; it narrows with the residuals
  double least_gate_m = 0.02;  // and never falls below
  double normal_deg = 45;      // largest angle of compatible normals
  int max_iterations = 60;
  double scale_floor_m = 0.0005;  // least scale of the robust weights
  double overlap_m = 0.05;        // a sample this near a surface of the other lies on it
  double clear_m = 0.15;          // a line of sight that goes on so far behind a sample contradicts it
  bool few = false;               // an eighth of the samples: enough to tell a pose that is far from right
  bool fewest = false;            // of these again an eighth
};

// A scan whose pose stays.
struct PlacedScan {
  const IcpScan* scan = nullptr;
  Pose world_from_scan;
};

// Of the scan against one that is placed, as shares of area.
struct ScanOverlap {
  double overlap = 0;     // of the one that sees less of it, on surfaces of the other
  double on_m2 = 0;       // of both, on surfaces of the other
  double through_m2 = 0;  // of both, where the other looks through it
  double rms_m = 0;       // of what lies on surfaces
};

// Of planar samples of all scans compared, sums of area times n nT, square metres; n: their normals, world.
// Along a direction d, dT sum d is what bears on a shift along it: of ground and walls that the scan slides
// along nothing, however large they are.
struct ComparedPlanes {
  Mat3 on = Mat3::Zero();       // on surfaces
  Mat3 through = Mat3::Zero();  // seen through
  // Seen through of planes of which more is seen through by one other scan than lies on its surfaces. Under
  // right poses it is edges that are seen through, of all planes a little; under wrong ones whole planes.
  double contradicted_m2 = 0;
  // Of planes of which more lies beside a surface of one other scan, by less than clear_m, than on it; and
  // the largest mean height over surfaces, without sign, of those of 1 % of their scan's area and more. Of
  // places that are alike walls stand centimetres beside each other.
  double beside_m2 = 0, farthest_m = 0;

  struct Weakest {
    double share = 0;  // of what lies on surfaces, what bears on a shift along `direction`
    Vec3 direction = Vec3::UnitZ();
  };
  // The direction along which least holds.
  Weakest weakest() const;
  // Of the area that can be compared, 0 where there is none: contradicted_m2, beside_m2.
  double contradicted() const;
  double beside() const;

  ComparedPlanes& operator+=(const ComparedPlanes& with_others);
};

// What samples of a scan and of others that are placed say of a place of the scan.
struct PlaceEvidence {
  // Share of all planar samples that lie on surfaces or are seen through, both ways; where planes are less
  // than a fifth of these, of all samples.
  double seen_through = 0;
  ComparedPlanes planes;
  // Of samples of no plane alone, both ways, and the area of them that lies on surfaces or is seen through.
  double free_seen_through = 0, free_m2 = 0;

  // What they and still other scans say of the same place.
  PlaceEvidence& operator+=(const PlaceEvidence& of_others);
};

struct ScanIcp : PlaceEvidence {
  Registration icp;  // overlap: share of the scan's area on surfaces of any of the others
  std::vector<ScanOverlap> others;
};

// METHOD 6, scan to scan: point-to-plane ICP of a scan's samples, planar and not, on the range images of
// others, and of theirs on its own: each sample is projected into the other's grid and paired with the
// nearest sample there whose normal is compatible (kernels closest_sample, icp_sums). Planar samples and
// the others have robust weights of their own, Tukey's with a scale that at most halves per iteration, and
// count by what they are off; the gate follows these scales. The start's place is kept along directions that
// the pairs leave open. Without pairs the pose is the start, `icp.overlap` 0.
ScanIcp register_to_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                          const Pose& start, const ScanIcpOptions& options = {});

// What register_to_scans() says of a pose that was found otherwise.
ScanIcp assess_on_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                        const Pose& pose, const ScanIcpOptions& options = {});

// Of that only what lies on surfaces and what is seen through, which needs no sums: icp's rms, covariance and
// directions left open stay as they are made. `enough`: asked when samples of no plane alone are compared
// (free_seen_through, free_m2); where it says so, planes are not.
ScanIcp compare_on_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                         const Pose& pose, const ScanIcpOptions& options = {},
                         const std::function<bool(const ScanIcp&)>& enough = {});

// Of the placed scans those that overlap with it so far that ICP can do without the others.
std::vector<PlacedScan> near_scans(const std::vector<PlacedScan>& placed, const ScanIcp& found);

// register_to_scans() on some of the placed (on all where these are none), and what assess_on_scans() says of
// its end on all.
ScanIcp register_to_some(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& some,
                         const std::vector<PlacedScan>& placed, const Pose& start,
                         const ScanIcpOptions& options = {});

}  // namespace hybrid::stages
