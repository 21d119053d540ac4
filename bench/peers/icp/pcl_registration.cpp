#include "icp/pcl_registration.hpp"

#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls.h>

namespace hybrid::peers {
namespace {

using NormalPoint = pcl::PointNormal;
using Icp = pcl::IterativeClosestPoint<NormalPoint, NormalPoint>;

}  // namespace

NormalCloud::Ptr proxy_cloud(const ProxyMesh& mesh, std::size_t count) {
  const SampledProxy sampled = sample_proxy(mesh, count);
  const NormalCloud::Ptr cloud(new NormalCloud);
  for (std::size_t i = 0; i < sampled.points.size(); ++i) {
    NormalPoint point;
    point.getVector3fMap() = sampled.points[i];
    point.getNormalVector3fMap() = sampled.normals[i];
    cloud->push_back(point);
  }
  return cloud;
}

Eigen::Matrix4d register_by_pcl(const NormalCloud::Ptr& source, const NormalCloud::Ptr& target,
                                const Eigen::Matrix4d& start, bool plane,
                                const std::vector<double>& gates_m) {
  Icp icp;
  if (plane)
    icp.setTransformationEstimation(Icp::TransformationEstimationPtr(
        new pcl::registration::TransformationEstimationPointToPlaneLLS<NormalPoint, NormalPoint>));
  icp.setInputSource(source);
  icp.setInputTarget(target);
  icp.setMaximumIterations(50);
  icp.setTransformationEpsilon(1e-10);
  icp.setEuclideanFitnessEpsilon(1e-9);
  Eigen::Matrix4f pose = start.cast<float>();
  for (const double gate_m : gates_m) {
    icp.setMaxCorrespondenceDistance(gate_m);
    NormalCloud aligned;
    icp.align(aligned, pose);
    pose = icp.getFinalTransformation();
  }
  return pose.cast<double>();
}

}  // namespace hybrid::peers
