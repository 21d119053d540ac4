#pragma once
#include <cstdint>
#include <vector>

#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// Squares of a region that have a neighbour outside it. By index + 1.
std::vector<std::uint32_t> rim_squares(const SquareGrid& grid, const PlaneRegions& regions, std::uint32_t id);

// From one square to another.
struct PlaneGap {
  int row = 0, col = 0;    // the square it starts from
  int rows = 0, cols = 0;  // to the square it ends at; columns the short way round
};

// Between the nearest pair among at most 256 squares of each rim, evenly chosen.
PlaneGap nearest_squares(const SquareGrid& grid, const std::vector<std::uint32_t>& from,
                         const std::vector<std::uint32_t>& to);

// A sample lies so far behind a plane that its ray went through it.
double seen_through_m(const SquarePlanes& squares, const SuperclusterOptions& options);

// Whether the scan looks through the plane between two parts of it: the rays of more than a tenth of the
// samples along the gap went on behind it. Samples on it or in front of it hide what is there.
bool is_seen_through(const RangeImage& image, const SquarePlanes& squares, const Plane& plane,
                     const PlaneGap& gap, const SuperclusterOptions& options);

}  // namespace hybrid::stages
