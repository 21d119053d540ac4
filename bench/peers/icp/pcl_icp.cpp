// PCL's ICP against the proxy sampled to a million points with normals: point-to-point, and point-to-plane
// with linear least squares. The number in the variant's name is the gate in centimetres.
#include <pcl/console/print.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls.h>

#include "shared/icp_peer.hpp"

namespace hybrid::peers {
namespace {

using Point = pcl::PointNormal;
using Cloud = pcl::PointCloud<Point>;
using Icp = pcl::IterativeClosestPoint<Point, Point>;

constexpr std::size_t kTargetPoints = 1'000'000;

Cloud::Ptr target_of(const ProxyMesh& mesh) {
  const SampledProxy sampled = sample_proxy(mesh, kTargetPoints);
  const Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < sampled.points.size(); ++i) {
    Point point;
    point.getVector3fMap() = sampled.points[i];
    point.getNormalVector3fMap() = sampled.normals[i];
    cloud->push_back(point);
  }
  return cloud;
}

Cloud::Ptr source_of(const std::vector<PlyPoint>& points) {
  const Cloud::Ptr cloud(new Cloud);
  for (const PlyPoint& p : points) {
    Point point;
    point.getVector3fMap() = Eigen::Vector3f(p[0], p[1], p[2]);
    cloud->push_back(point);
  }
  return cloud;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return icp_main(argc, argv, "PCL " PCL_VERSION_PRETTY,
                  {"plane-50", "plane-15", "plane-5", "point-50", "point-15"},
                  [](const IcpInput& input, Report& report) {
                    const bool plane = input.variant.starts_with("plane");
                    const double gate_m = std::stod(input.variant.substr(input.variant.find('-') + 1)) / 100;
                    const auto source = source_of(input.source), target = target_of(input.proxy);
                    const Stopwatch watch;
                    Icp icp;
                    if (plane)
                      icp.setTransformationEstimation(Icp::TransformationEstimationPtr(
                          new pcl::registration::TransformationEstimationPointToPlaneLLS<Point, Point>));
                    icp.setInputSource(source);
                    icp.setInputTarget(target);
                    icp.setMaxCorrespondenceDistance(gate_m);
                    icp.setMaximumIterations(50);
                    icp.setTransformationEpsilon(1e-10);
                    icp.setEuclideanFitnessEpsilon(1e-9);
                    Cloud aligned;
                    icp.align(aligned, input.start.cast<float>());
                    report.seconds = watch.seconds();
                    report.settings = std::string(plane ? "point-to-plane" : "point-to-point") + ", gate " +
                                      input.variant.substr(input.variant.find('-') + 1) +
                                      " cm, proxy as 1 M points, tree included, 1 thread (it has no more)";
                    return IcpResult{icp.getFinalTransformation().cast<double>(), -1};
                  });
}
