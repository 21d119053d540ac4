#pragma once
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// Of what a scan and one other see through of each other: the geometric mean of the shares of all that can be
// compared and of what is no plane (mouldings, tracery, ivy). Places that are alike have planes that fit, so
// that little is seen through of all; what is no plane tells them.
double alike_through(const ScanIcp& found);

struct PairPlaceOptions {
  ScanIcpOptions icp;
  // alike_through() of a place, and ScanIcp::free_seen_through. Opposite aisles and sides of churches laid on
  // each other, and sides shifted by a bay, have 0.023 and more of the former, and sides 0.12 and more of the
  // latter; all right places but a few 0.016, and 0.04, at most.
  double most_alike_through = 0.018, most_free_through = 0.06;
  // ScanIcp::seen_through. Right places, but for a corner with another or with a side (0.029), have 0.024 at
  // most.
  double most_through = 0.025;
  // Of the scan's area, or of the other's, on surfaces of the other, and of the scan's area, samples of no
  // plane that can be compared: with less a place is not told.
  double least_overlap = 0.3, least_free = 0.008;
  // What planes are off the other's (ComparedPlanes::farthest_m), and the share of the planar area of those
  // that lie beside it. Right places have 0.8 mm and nothing, rooms of nearly one size 4 cm or 0.046.
  double most_off_m = 0.01, most_beside = 0.005;
  // Of the planar area on surfaces, what bears on a shift along the direction along which least does.
  double least_held = 0.005;
};

// Of some places of a scan on one other.
struct PairPlaces {
  // After ICP, each once: those that the samples do not contradict, the least contradicted first.
  std::vector<ScanIcp> open;
  std::vector<Pose> uncontradicted;  // with those that overlap too little to be rivals
  bool fits = false;                 // the first one is held, and the samples speak for it
  bool is_told() const { return fits && open.size() == 1; }
};

// METHOD 7, scan to scan: two scans before a wall share too few planes for these to tell their places alone,
// but see the same of what is no plane. Each place is refined by register_to_scans(). One is told where
// little of all and of what is no plane is seen through, it is held along all directions, and each other one
// is contradicted: twice as much seen through as a place may have, or less overlaps.
PairPlaces tell_places(device::Queue& queue, const IcpScan& scan, const PlacedScan& other,
                       const std::vector<Pose>& places, const PairPlaceOptions& options = {});

}  // namespace hybrid::stages
