// The paper's method as a PCL user writes it: SACSegmentation per square, squares grown into planes.
#include <pcl/console/print.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include "shared/grow_squares.hpp"
#include "shared/planes_peer.hpp"

namespace hybrid::peers {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

SquareFit fit_square(const RangeScan& scan, const std::vector<std::uint32_t>& nodes,
                     pcl::SACSegmentation<pcl::PointXYZ>& segmentation) {
  const Cloud::Ptr cloud(new Cloud);
  for (std::uint32_t i : nodes) cloud->push_back({scan.x[i], scan.y[i], scan.z[i]});
  segmentation.setInputCloud(cloud);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  segmentation.segment(inliers, plane);
  SquareFit fit;
  if (plane.values.size() != 4 || 10 * inliers.indices.size() < 8 * nodes.size()) return fit;
  fit.planar = true;
  fit.normal = Eigen::Vector3f(plane.values[0], plane.values[1], plane.values[2]);
  fit.centroid.setZero();
  for (int i : inliers.indices) fit.centroid += (*cloud)[static_cast<std::size_t>(i)].getVector3fMap();
  fit.centroid /= static_cast<float>(inliers.indices.size());
  if (fit.normal.dot(fit.centroid) > 0) fit.normal = -fit.normal;
  return fit;
}

std::vector<SquareFit> fit_squares(const RangeScan& scan, const SquareExtent& extent, double sigma_m) {
  std::vector<SquareFit> fits(extent.count());
#pragma omp parallel
  {
    pcl::SACSegmentation<pcl::PointXYZ> segmentation;
    segmentation.setModelType(pcl::SACMODEL_PLANE);
    segmentation.setMethodType(pcl::SAC_RANSAC);
    segmentation.setMaxIterations(32);
    segmentation.setDistanceThreshold(3 * sigma_m + 0.002);
    segmentation.setOptimizeCoefficients(true);
    std::vector<std::uint32_t> nodes;
#pragma omp for schedule(dynamic, 8)
    for (int row = 0; row < extent.rows; ++row)
      for (int col = 0; col < extent.cols; ++col) {
        square_nodes(scan, extent, row, col, nodes);
        if (nodes.size() < 3 || 10 * nodes.size() < 7u * static_cast<unsigned>(extent.side * extent.side))
          continue;
        fits[static_cast<std::size_t>(row) * static_cast<std::size_t>(extent.cols) +
             static_cast<std::size_t>(col)] = fit_square(scan, nodes, segmentation);
      }
  }
  return fits;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return planes_main(argc, argv, "PCL " PCL_VERSION_PRETTY, {"32"},
                     [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
                       const SquareExtent extent(scan, options.square);
                       report.settings = "at most 32 test planes, " + std::to_string(options.square) + " x " +
                                         std::to_string(options.square) + " squares";
                       const Stopwatch watch;
                       const auto fits = fit_squares(scan, extent, options.sigma_m);
                       report.parts["squares"] = watch.seconds();
                       if (options.squares_only) return std::vector<std::uint32_t>();
                       return grow_squares(scan, extent, fits, options.sigma_m);
                     });
}
