#pragma once
#include <string>
#include <vector>

#include "stages/registration/sight_lines.hpp"

namespace hybrid::stages {

// What the lines of sight say for one pose against another, as shares of the planar area. A line speaks for a
// pose only where that pose has a face right where the sample is and the other pose clearly contradicts it:
// the line would pass through the other's face (counts whole), end in front of it or look at its back (half).
// Where the other has no face it says next to nothing (a twentieth), as a model is never complete; samples
// within SightOptions::clear_m of the other's face say nothing, because faces are off by centimetres.
struct Comparison {
  double for_it = 0, against_it = 0;
  // Of the scan plane that says most: all it says for the pose, and what of it is firm. Firm is what the
  // other pose would see through its faces, and what of a wall goes on where the other pose has a recess: of
  // a plane most of which lies on the other pose's faces too, what lies in front of them is no furniture and
  // counts whole. So does a plane that reaches from floor to ceiling (SightRay::spans).
  double largest = 0, largest_firm = 0;
  // Of what speaks against the pose, what may be a recess that the model lacks, and counts half in
  // strength(): seen through the pose's faces, of planes that do not reach from floor to ceiling, on the
  // other's walls.
  double against_recess = 0;
  double without_largest() const { return for_it - largest; }
  double gap() const { return for_it - against_it; }
};
Comparison compare(const std::vector<SightRay>& rays, const std::vector<SightLine>& pose,
                   const std::vector<SightLine>& other);

// The least that must speak for a pose against every rival, shares of the planar area. More than one plane
// must speak (`least_without_largest`), as one piece of furniture can look like a wall; or one plane firmly
// (`least_firm`); or one as large as a wall (`least_single`).
struct MarginRule {
  double least_gap = 0.003;
  double least_consistency = 0.5;  // 1: all evidence points one way; 0: as much either way
  double least_without_largest = 0.0015;
  double least_firm = 0.003;
  double least_single = 0.06;
};

// How far the comparison is above the rule, as a factor; below 1 the rule fails.
double strength(const Comparison& comparison, const MarginRule& rule);

// How much of the planar area that faces along some direction contradicts a pose, against what of it supports
// the pose, for the worst direction: 0 everything fits; 1 as much lies off the faces as on them, as when one
// of two opposite walls of another room was laid on a wall of this one. What has no face before it is left
// out, and what may be furniture (not SightRay::spans) counts less.
double doubt(const ScanEvidence& scan, const std::vector<SightLine>& pose);

}  // namespace hybrid::stages
