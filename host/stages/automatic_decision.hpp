#pragma once
#include <string>
#include <vector>

#include "stages/sight_lines.hpp"

namespace hybrid::stages {

// What the lines of sight say for one pose against another, as shares of the planar area. A line speaks for a
// pose only where that pose has a face right where the sample is and the other pose clearly contradicts it:
// the line would pass through the other's face (counts whole), end in front of it or look at its back (half).
// Where the other has no face it says next to nothing (a twentieth), as a model is never complete; samples
// within SightOptions::clear_m of the other's face say nothing, because faces are off by centimetres.
struct Comparison {
  double for_it = 0, against_it = 0;
  // for_it without the scan plane that says most: one piece of furniture can look like a wall.
  double without_largest = 0;
  double gap() const { return for_it - against_it; }
  // 1: all evidence points one way; 0: as much speaks for one as for the other.
  double consistency() const {
    const double all = for_it + against_it;
    return all > 0 ? gap() / all : 0;
  }
};
Comparison compare(const std::vector<SightRay>& rays, const std::vector<SightLine>& pose,
                   const std::vector<SightLine>& other);

// The least that must speak for a pose against every rival.
struct MarginRule {
  double least_gap = 0.01;
  double least_consistency = 0.6;
  double least_without_largest = 0.003;
};

// How far the comparison is above the rule, as a factor; below 1 the rule fails.
double strength(const Comparison& comparison, const MarginRule& rule);

}  // namespace hybrid::stages
