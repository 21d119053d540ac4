#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/bvh_records.h"

namespace hybrid::stages {

// Spheres that lie together.
struct SphereCluster {
  std::uint32_t begin = 0, count = 0;  // of SphereClusters::order
};

struct SphereClusters {
  std::vector<std::uint32_t> order;  // per place, the sphere's index; along a space-filling curve
  std::vector<SphereCluster> clusters;
};

inline constexpr std::size_t kLargestCluster = 64;

// Cuts the spheres into cells of an octree that hold at most kLargestCluster of them (Morton order,
// Lauterbach et al. 2009); only of spheres in one place, or too close for floats, more than a cell's fill
// several clusters. The same for any number of threads. Coordinates must be finite.
SphereClusters cluster_spheres(const std::vector<SphereRecord>& spheres);

}  // namespace hybrid::stages
