#pragma once
#include <cstdint>
#include <vector>

#include "device/queue.hpp"
#include "shared/bvh_records.h"

namespace hybrid::stages {

// Bounding volume hierarchy over triangles and spheres, in the layout of shared/bvh_records.h. Metres,
// relative to one local origin.
struct Bvh {
  std::vector<BvhNode> nodes;                // empty when the root is a leaf
  std::vector<TriangleRecord> triangles;     // in the order of the leaves
  std::vector<SphereRecord> spheres;         // in the order of the leaves
  std::vector<std::uint32_t> sphere_source;  // index in the input of each of `spheres`
  std::uint32_t root = BVH_EMPTY;
};

// Binned surface area heuristic (Wald 2007) over triangles and clusters of spheres (bvh_clusters.hpp), then
// within each cluster, in parallel; the same tree for any number of threads. Speed: bench/bvh/bvh_speed.cpp.
// Coordinates must be finite, radii positive. Throws ErrorKind::input beyond 2^26 primitives.
// `beside`: a tree that there is to be room for (bvh_join.hpp).
Bvh build_bvh(const std::vector<TriangleRecord>& triangles, const std::vector<SphereRecord>& spheres,
              const Bvh& beside = {});

// The same on the device. surfaces[i] belongs to spheres[i].
struct DeviceBvh {
  device::Array<BvhNode> nodes;
  device::Array<TriangleRecord> triangles;
  device::Array<SphereRecord> spheres;  // and BVH_LARGEST_LEAF - 1 of no meaning
  device::Array<SphereSurface> surfaces;
  std::uint32_t root = BVH_EMPTY;           // of what primary rays meet
  std::uint32_t occluder_root = BVH_EMPTY;  // of that and the curtains: what shadow rays meet
  std::uint32_t curtain_root = BVH_EMPTY;   // of the curtains alone
};

// `surfaces`: one per sphere of the input build_bvh had.
DeviceBvh upload_bvh(device::Queue& queue, const Bvh& bvh, const std::vector<SphereSurface>& surfaces);

}  // namespace hybrid::stages
