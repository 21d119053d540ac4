// Open3D's RANSAC plane, taken off again and again: what its users do for many planes (the packaged version
// has no planar patches).
#include <open3d/Open3DConfig.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/utility/Random.h>

#include <algorithm>

#include "shared/planes_peer.hpp"

namespace {
constexpr int kMostPlanes = 40, kTestPlanes = 1000;
}

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  return planes_main(
      argc, argv, "Open3D " OPEN3D_VERSION, {"peeling"},
      [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
        auto nodes = valid_nodes(scan);
        const std::size_t least = std::max<std::size_t>(200, nodes.size() / 5000);
        auto cloud = std::make_shared<open3d::geometry::PointCloud>();
        for (std::uint32_t i : nodes) cloud->points_.emplace_back(scan.x[i], scan.y[i], scan.z[i]);
        open3d::utility::random::Seed(1);
        const Stopwatch watch;
        std::vector<std::uint32_t> labels(scan.count(), 0);
        for (std::uint32_t plane = 1; plane <= kMostPlanes && cloud->points_.size() >= least; ++plane) {
          const auto [equation, inliers] = cloud->SegmentPlane(3 * options.sigma_m + 0.002, 3, kTestPlanes);
          if (inliers.size() < least) break;
          for (std::size_t i : inliers) labels[nodes[i]] = plane;
          std::erase_if(nodes, [&](std::uint32_t i) { return labels[i] != 0; });
          cloud = cloud->SelectByIndex(inliers, true);
        }
        report.seconds = watch.seconds();
        report.settings = "at most 40 planes of 1000 test planes each, 3 sigma + 2 mm";
        return labels;
      });
}
