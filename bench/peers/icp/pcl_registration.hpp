#pragma once
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <vector>

#include "shared/proxy_obj.hpp"

namespace hybrid::peers {

using NormalCloud = pcl::PointCloud<pcl::PointNormal>;

// The proxy as so many points with normals.
NormalCloud::Ptr proxy_cloud(const ProxyMesh& mesh, std::size_t count);

// PCL's ICP with each gate in turn, every one starting where the one before ended: point-to-point, or
// point-to-plane with linear least squares; at most 50 iterations each. World frame.
Eigen::Matrix4d register_by_pcl(const NormalCloud::Ptr& source, const NormalCloud::Ptr& target,
                                const Eigen::Matrix4d& start, bool plane, const std::vector<double>& gates_m);

}  // namespace hybrid::peers
