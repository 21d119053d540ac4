// Open3D's point-to-plane ICP against the proxy sampled to a million points with normals.
#include <open3d/Open3DConfig.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/pipelines/registration/TransformationEstimation.h>

#include "shared/icp_peer.hpp"

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  namespace registration = open3d::pipelines::registration;
  return icp_main(
      argc, argv, "Open3D " OPEN3D_VERSION, {"plane-15"}, [](const IcpInput& input, Report& report) {
        const SampledProxy sampled = sample_proxy(input.proxy, 1'000'000);
        open3d::geometry::PointCloud source, target;
        for (const PlyPoint& p : input.source) source.points_.emplace_back(p[0], p[1], p[2]);
        for (const auto& p : sampled.points) target.points_.push_back(p.cast<double>());
        for (const auto& n : sampled.normals) target.normals_.push_back(n.cast<double>());
        const Stopwatch watch;
        const auto result = registration::RegistrationICP(
            source, target, 0.15, input.start, registration::TransformationEstimationPointToPlane(),
            registration::ICPConvergenceCriteria(1e-9, 1e-9, 50));
        report.seconds = watch.seconds();
        report.settings = "point-to-plane, gate 15 cm, proxy as 1 M points, tree included";
        return IcpResult{result.transformation_, -1};
      });
}
