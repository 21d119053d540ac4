#pragma once
#include <CGAL/Simple_cartesian.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <CGAL/tags.h>
#include <CGAL/version.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "shared/planes_peer.hpp"

namespace hybrid::peers {

using CgalKernel = CGAL::Simple_cartesian<double>;
// Point, normal and node: CGAL's RANSAC reorders its input, so that a place in the list says nothing later.
using CgalPoint = std::tuple<CgalKernel::Point_3, CgalKernel::Vector_3, std::uint32_t>;
using CgalCloud = std::vector<CgalPoint>;
using CgalPointMap = CGAL::Nth_of_tuple_property_map<0, CgalPoint>;
using CgalNormalMap = CGAL::Nth_of_tuple_property_map<1, CgalPoint>;

// The points of the given nodes, in their order, with normals from their 12 nearest neighbours, towards the
// scanner.
inline CgalCloud cgal_cloud(const RangeScan& scan, const std::vector<std::uint32_t>& nodes) {
  CgalCloud cloud;
  cloud.reserve(nodes.size());
  for (std::uint32_t i : nodes)
    cloud.push_back({{scan.x[i], scan.y[i], scan.z[i]}, CgalKernel::Vector_3(0, 0, 0), i});
  CGAL::pca_estimate_normals<CGAL::Parallel_if_available_tag>(
      cloud, 12, CGAL::parameters::point_map(CgalPointMap()).normal_map(CgalNormalMap()));
  for (auto& [point, normal, node] : cloud)
    if (normal * (point - CGAL::ORIGIN) > 0) normal = -normal;
  return cloud;
}

// A plane has at least this many points.
inline std::size_t least_points(std::size_t count) {
  return std::max<std::size_t>(200, count / 5000);
}

}  // namespace hybrid::peers
