#include "planes/pcl_organised.hpp"

#include <pcl/features/integral_image_normal.h>
#include <pcl/segmentation/organized_multi_plane_segmentation.h>

#include <cmath>
#include <numbers>

#include "shared/peer_report.hpp"

namespace hybrid::peers {
namespace {

using Point = pcl::PointXYZ;
using Cloud = OrganisedCloud;
using Normals = pcl::PointCloud<pcl::Normal>;

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

OrganisedPlanes segment(const Cloud::Ptr& cloud, const Normals::Ptr& normals, double sigma_m) {
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
  OrganisedPlanes found;
  found.labels.assign(cloud->size(), 0);
  for (std::size_t plane = 0; plane < inliers.size(); ++plane) {
    for (int i : inliers[plane].indices)
      found.labels[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(plane) + 1;
    found.planes.emplace_back(planes[plane].values.data());
  }
  for (const auto& region : regions) {
    const auto contour = region.getContour();
    found.contours.emplace_back();
    for (const Point& point : contour) found.contours.back().push_back(point);
  }
  return found;
}

}  // namespace

OrganisedPlanes find_organised_planes(const OrganisedCloud::Ptr& cloud, bool gradient, std::size_t measured,
                                      double sigma_m) {
  const Stopwatch watch;
  const float smoothing_px = smoothing_for(measured, gradient);
  const auto normals = normals_of(cloud, gradient, smoothing_px);
  const double normals_s = watch.seconds();
  auto found = segment(cloud, normals, sigma_m);
  found.normals_s = normals_s;
  found.settings = std::string(gradient ? "average 3D gradient" : "covariance") + ", smoothing " +
                   std::to_string(static_cast<int>(std::lround(smoothing_px))) + " px";
  return found;
}

}  // namespace hybrid::peers
