#pragma once
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hybrid::peers {

using OrganisedCloud = pcl::PointCloud<pcl::PointXYZ>;

struct OrganisedPlanes {
  std::vector<std::uint32_t> labels;     // per node, 0 = none; plane k has label k + 1
  std::vector<Eigen::Vector4f> planes;   // a b c d
  std::vector<OrganisedCloud> contours;  // of each plane
  double normals_s = 0;                  // of its seconds
  std::string settings;
};

// PCL's own chain for organised clouds: normals from integral images (covariance, or the average 3D
// gradient), then OrganizedMultiPlaneSegmentation with refinement. `measured`: nodes with a return, which
// settle how wide the normals' windows are.
OrganisedPlanes find_organised_planes(const OrganisedCloud::Ptr& cloud, bool gradient, std::size_t measured,
                                      double sigma_m);

}  // namespace hybrid::peers
