// PCL's own chain for organised clouds: normals from integral images, then OrganizedMultiPlaneSegmentation
// with refinement. Variants: how normals are found, and whether the scan's holes are filled first (`-holes`:
// not).
#include <pcl/console/print.h>
#include <pcl/features/integral_image_normal.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/organized_multi_plane_segmentation.h>

#include <cmath>
#include <numbers>

#include "shared/planes_peer.hpp"

namespace hybrid::peers {
namespace {

using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;
using Normals = pcl::PointCloud<pcl::Normal>;

Cloud::Ptr cloud_of(const RangeScan& scan) {
  const Cloud::Ptr cloud(new Cloud(static_cast<unsigned>(scan.cols), static_cast<unsigned>(scan.rows)));
  cloud->is_dense = false;
  for (std::size_t i = 0; i < scan.count(); ++i) (*cloud)[i] = {scan.x[i], scan.y[i], scan.z[i]};
  return cloud;
}

Normals::Ptr normals_of(const Cloud::Ptr& cloud, bool gradient, float smoothing_px) {
  using Estimation = pcl::IntegralImageNormalEstimation<Point, pcl::Normal>;
  Estimation estimation;
  estimation.setNormalEstimationMethod(gradient ? Estimation::AVERAGE_3D_GRADIENT
                                                : Estimation::COVARIANCE_MATRIX);
  estimation.setMaxDepthChangeFactor(0.02f);
  estimation.setNormalSmoothingSize(smoothing_px);
  estimation.setInputCloud(cloud);
  const Normals::Ptr normals(new Normals);
  estimation.compute(*normals);
  return normals;
}

// Wide windows round the corners until regions flow over them, narrow ones leave the noise in: finer scans
// need more samples, not as many more. README.md has what each costs.
float smoothing_for(std::size_t samples, bool gradient) {
  const double growth = std::pow(static_cast<double>(samples) / 5e6, 0.25);
  return static_cast<float>(std::max(5.0, (gradient ? 5 : 7) * growth));
}

std::vector<std::uint32_t> segment(const Cloud::Ptr& cloud, const Normals::Ptr& normals, double sigma_m) {
  pcl::OrganizedMultiPlaneSegmentation<Point, pcl::Normal, pcl::Label> segmentation;
  segmentation.setMinInliers(static_cast<unsigned>(std::max<std::size_t>(200, cloud->size() / 5000)));
  segmentation.setAngularThreshold(3 * std::numbers::pi / 180);
  segmentation.setDistanceThreshold(10 * sigma_m);
  segmentation.setInputNormals(normals);
  segmentation.setInputCloud(cloud);
  std::vector<pcl::PlanarRegion<Point>, Eigen::aligned_allocator<pcl::PlanarRegion<Point>>> regions;
  std::vector<pcl::ModelCoefficients> planes;
  std::vector<pcl::PointIndices> inliers, label_indices, boundaries;
  pcl::PointCloud<pcl::Label>::Ptr plane_labels(new pcl::PointCloud<pcl::Label>);
  segmentation.segmentAndRefine(regions, planes, inliers, plane_labels, label_indices, boundaries);
  std::vector<std::uint32_t> labels(cloud->size(), 0);
  for (std::size_t plane = 0; plane < inliers.size(); ++plane)
    for (int i : inliers[plane].indices)
      labels[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(plane) + 1;
  return labels;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return planes_main(
      argc, argv, "PCL " PCL_VERSION_PRETTY, {"covariance", "gradient", "covariance-holes", "gradient-holes"},
      [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
        const bool gradient = options.variant.starts_with("gradient"),
                   holes = options.variant.ends_with("holes");
        const auto cloud = cloud_of(holes ? with_holes(scan) : with_holes_filled(scan));
        // Converting is not what a PCL user, whose data start in PCL's form, would wait for.
        const Stopwatch watch;
        const float smoothing_px = smoothing_for(scan.measured(), gradient);
        const auto normals = normals_of(cloud, gradient, smoothing_px);
        report.parts["normals"] = watch.seconds();
        const auto labels = segment(cloud, normals, options.sigma_m);
        report.seconds = watch.seconds();
        report.settings = std::string(gradient ? "average 3D gradient" : "covariance") +
                          (holes ? ", the scan's holes left in" : ", holes filled") + ", smoothing " +
                          std::to_string(static_cast<int>(std::lround(smoothing_px))) + " px";
        return labels;
      });
}
