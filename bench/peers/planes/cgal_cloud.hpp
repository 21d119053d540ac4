#pragma once
#include <CGAL/Simple_cartesian.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <CGAL/tags.h>
#include <CGAL/version.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "shared/planes_peer.hpp"

namespace hybrid::peers {

using CgalKernel = CGAL::Simple_cartesian<double>;
using CgalPoint = std::pair<CgalKernel::Point_3, CgalKernel::Vector_3>;
using CgalCloud = std::vector<CgalPoint>;
using CgalPointMap = CGAL::First_of_pair_property_map<CgalPoint>;
using CgalNormalMap = CGAL::Second_of_pair_property_map<CgalPoint>;

// The points of the given nodes, in their order, with normals from their 12 nearest neighbours, towards the
// scanner.
inline CgalCloud cgal_cloud(const RangeScan& scan, const std::vector<std::uint32_t>& nodes) {
  CgalCloud cloud;
  cloud.reserve(nodes.size());
  for (std::uint32_t i : nodes)
    cloud.push_back({{scan.x[i], scan.y[i], scan.z[i]}, CgalKernel::Vector_3(0, 0, 0)});
  CGAL::pca_estimate_normals<CGAL::Parallel_if_available_tag>(
      cloud, 12, CGAL::parameters::point_map(CgalPointMap()).normal_map(CgalNormalMap()));
  for (auto& [point, normal] : cloud)
    if (normal * (point - CGAL::ORIGIN) > 0) normal = -normal;
  return cloud;
}

// A plane has at least this many points.
inline std::size_t least_points(std::size_t count) {
  return std::max<std::size_t>(200, count / 5000);
}

}  // namespace hybrid::peers
