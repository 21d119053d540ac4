#pragma once
#include <string>
#include <vector>

#include "stages/registration/place_tallies.hpp"
#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

struct HypothesesOptions {
  ScanIcpOptions icp;
  double reach_m = 1;  // a hypothesis that is contradicted may be so far off, along what contradicts it
  double most_through = 0.05;  // ScanIcp::seen_through that a pose may have
  // What may be seen through along any direction, of what bears on a shift along it (ComparedPlanes). On
  // churches right poses have 0.05 at most, wrong ones 0.9 and more; but the other side of a church, slid to
  // where it fits, has 0.04 to 0.09, and a room turned by half 0.06 to 0.16: see most_contradicted,
  // most_free.
  double most_along = 0.1;
  // What bears on a shift along any direction and lies on surfaces, of all that does. Right poses have 0.007
  // and more, wrong ones that nothing contradicts 0.0003.
  double least_held = 0.002;
  // Of the planar area that can be compared, that of planes that are seen through as a whole. Right poses
  // have 0.0001 at most, rooms turned by half 0.0017 to 0.04.
  double most_contradicted = 0.001;
  // ScanIcp::free_seen_through that it may have: right poses 0.08, the other side of the church 0.24 to 0.8.
  double most_free = 0.3;
  double least_overlap = 0.5;  // of the scan's area on surfaces of the others
  // Another place must overlap by this share of what the chosen one does to leave no choice: 0 where a model
  // has the hypotheses, more where nothing but overlap speaks for them.
  double least_rival = 0;
  // Of the planar area that can be compared, that of planes beside others' (ComparedPlanes::beside).
  double most_beside = 1;
  bool needs_free = false;  // samples of no plane must be there to be compared
};

// What became of the hypotheses of a scan's pose.
struct ChosenHypothesis {
  bool accepted = false;
  std::string reason;          // why not, in words
  bool found_any = false;      // not all hypotheses are contradicted: what follows says of the best
  bool has_rival = false;      // nothing tells it from another
  Pose start;                  // the hypothesis that the pose was found from
  ScanIcp found;               // of the best pose, on all scans
  double along = 0, held = 0;  // of it: as in the options
  int tried = 0;               // hypotheses
};

// METHOD 7, many scans: a scan that slides along a wall or fits more places of the model than one, as little
// of its area lies on what tells these apart, is laid on all scans that have a pose at once. Of each
// hypothesis it is asked what the scans see through along the direction that speaks most against it; a
// hypothesis may lie beside the right place along that direction. Accepted is a pose that nothing
// contradicts, that is held along all directions and that no other hypothesis leaves room for: each must be
// contradicted, by itself or where the accepted one is not; where nothing holds it along a direction,
// wherever it lies along that within reach. `tallies`: of the scan, from one call to the next.
ChosenHypothesis choose_hypothesis(device::Queue& queue, const IcpScan& scan,
                                   const std::vector<PlacedScan>& placed, const std::vector<Pose>& hypotheses,
                                   PlaceTallies& tallies, const HypothesesOptions& options = {});

}  // namespace hybrid::stages
