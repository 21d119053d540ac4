#pragma once
#include <cstdint>
#include <vector>

#include "geometry/cylinder.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::stages {

// Small planes on a grid: squares, or strips of them. Those that lie on no plane of the scan are free.
struct Facets {
  const SquarePlanes& planes;
  int height, width;  // samples
  std::vector<std::uint8_t> free;
};

// The cylinders that these facets of one image show (find_cylinders says how), in the order of their facets,
// ids left 0: columns and pipes or, `inside`, vaults and arches. `labels`: per node, 0 where it lies on no
// plane.
std::vector<Cylinder> search_cylinders(const RangeImage& image, Facets facets,
                                       const std::vector<std::uint32_t>& labels,
                                       const SuperclusterOptions& options, bool inside);

}  // namespace hybrid::stages
