#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// What scans see through of each other, sums over pairs of them.
struct SeenByPairs {
  ComparedPlanes planes;
  double free_through_m2 = 0, free_m2 = 0;  // samples of no plane: seen through; that, and on surfaces
  void add(const ScanIcp& pair);
  double planes_through() const;  // share of the planar area that can be compared
  double free_through() const;    // share of what is no plane
  double alike_through() const;   // the geometric mean of the two, as pair_places.hpp has it
};

// Scans that lie right among themselves, moved as one, on scans that are placed.
struct IslandFit {
  Pose world_from_island;
  std::vector<std::size_t> order;  // of the island's scans: what lies most on placed ones first
  SeenByPairs all, near;           // near: of pairs that overlap by a fifth
  double overlap = 0;              // of the pair that overlaps most (ScanOverlap)
};

struct IslandOptions {
  ScanIcpOptions icp;
  // Of all pairs: planes_through(), alike_through() and free_through() of a place. Parts of churches have
  // 0.046, 0.049 and 0.071 at most where they belong, as hardly anything but ground at grazing angles can be
  // compared in most pairs; elsewhere those that walls hold have 0.089 and 0.16 at least of the latter two.
  double most_through = 0.05, most_alike_through = 0.05, most_free_through = 0.08;
  // Of the near ones. A box turned by half has 0.024 and more of alike_through() (of 60 rooms one 0.013).
  double most_near_through = 0.025, most_near_alike_through = 0.018, most_near_free_through = 0.04;
  // Of the largest scan's area, samples of no plane in near pairs, and of a scan's area, or of the other's,
  // on surfaces of the other in the pair that overlaps most: with less a place is not told.
  double least_free = 0.008, least_overlap = 0.3;
  double most_off_m = 0.01, most_beside = 0.005, least_held = 0.005;  // of near pairs, as PairPlaceOptions
};

// METHOD 7, scan to scan: where single scans do not tell their places, all of an island do together, as each
// place of one of them lays the others, too, where something is. Of the places (world from island) the one
// that the samples of all contradict least, after ICP of the scan that lies most on placed ones; nothing
// where it does not fit or they do not contradict each other one, by 2.5 times what a place may have of all
// pairs.
std::optional<IslandFit> tell_island_place(device::Queue& queue, const std::vector<PlacedScan>& island,
                                           const std::vector<PlacedScan>& placed,
                                           const std::vector<Pose>& places,
                                           const IslandOptions& options = {});

}  // namespace hybrid::stages
