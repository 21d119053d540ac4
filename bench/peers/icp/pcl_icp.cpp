// PCL's ICP against the proxy sampled to a million points with normals: point-to-point, and point-to-plane
// with linear least squares. The number in the variant's name is the gate in centimetres.
#include <pcl/console/print.h>
#include <pcl/pcl_config.h>

#include "icp/pcl_registration.hpp"
#include "shared/icp_peer.hpp"

namespace hybrid::peers {
namespace {

constexpr std::size_t kTargetPoints = 1'000'000;

NormalCloud::Ptr source_of(const std::vector<PlyPoint>& points) {
  const NormalCloud::Ptr cloud(new NormalCloud);
  for (const PlyPoint& p : points) {
    pcl::PointNormal point;
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
  return icp_main(
      argc, argv, "PCL " PCL_VERSION_PRETTY, {"plane-50", "plane-15", "plane-5", "point-50", "point-15"},
      [](const IcpInput& input, Report& report) {
        const bool plane = input.variant.starts_with("plane");
        const double gate_m = std::stod(input.variant.substr(input.variant.find('-') + 1)) / 100;
        const auto source = source_of(input.source), target = proxy_cloud(input.proxy, kTargetPoints);
        const Stopwatch watch;
        const auto pose = register_by_pcl(source, target, input.start, plane, {gate_m});
        report.seconds = watch.seconds();
        report.settings = std::string(plane ? "point-to-plane" : "point-to-point") + ", gate " +
                          input.variant.substr(input.variant.find('-') + 1) +
                          " cm, proxy as 1 M points, tree included, 1 thread (it has no more)";
        return IcpResult{pose, -1};
      });
}
