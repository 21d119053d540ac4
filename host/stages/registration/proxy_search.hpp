#pragma once
#include "device/queue.hpp"
#include "geometry/pose.hpp"
#include "shared/params_closest_point.h"
#include "shared/proxy_tree_records.h"
#include "stages/registration/proxy_model.hpp"

namespace hybrid::stages {

// Queries on the device, scan frame; normals NaN = none known.
struct SearchQueries {
  std::size_t count = 0;
  device::Array<float> x, y, z, nx, ny, nz;
};

// Answers on the device, as closest_point.cl has them.
struct SearchAnswers {
  device::Array<float> distance, height, near_x, near_y, near_z;
  device::Array<std::uint32_t> triangle;  // index in ProxySearch::triangles()
  SearchAnswers(device::Queue& queue, std::size_t count);
};

// Packets of a work-item of closest_point_tree on a device of `lanes`: each starts from what the last one
// found.
constexpr int packets_in_a_run(int lanes) {
  return lanes == 1 ? 1 : 8;
}

// The closest points of a model about an origin near the queries. Kernels: closest_point,
// closest_point_tree; which of them answers does not change a bit of the answer. Throws what
// proxy_triangles() throws.
class ProxySearch {
 public:
  // `origin` as in proxy_triangles().
  ProxySearch(device::Queue& queue, const ProxyModel& model, const Vec3& origin);

  // gate_m 0 = none; normal_deg outside [0, 180) = any normal.
  void find(const SearchQueries& queries, const Pose& local_from_scan, double gate_m, double normal_deg,
            SearchAnswers& answers);

  // In the order of the tree's leaves where there is a tree.
  const device::Array<ProxyTriangle>& triangles() const { return triangles_; }

 private:
  device::Queue& queue_;
  std::size_t count_ = 0;
  device::Array<ProxyTriangle> triangles_;
  device::Array<ProxyNode> nodes_;
  std::uint32_t root_ = BVH_EMPTY;  // none: brute force
};

}  // namespace hybrid::stages
