#pragma once
#include "planes/pcl_organised.hpp"
#include "shared/range_exr.hpp"

namespace hybrid::peers {

inline OrganisedCloud::Ptr organised_cloud(const RangeScan& scan) {
  const OrganisedCloud::Ptr cloud(
      new OrganisedCloud(static_cast<unsigned>(scan.cols), static_cast<unsigned>(scan.rows)));
  cloud->is_dense = false;
  for (std::size_t i = 0; i < scan.count(); ++i) (*cloud)[i] = {scan.x[i], scan.y[i], scan.z[i]};
  return cloud;
}

}  // namespace hybrid::peers
