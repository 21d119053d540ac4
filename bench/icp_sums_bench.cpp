#include "cases/icp_sums_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool icp_sums_plane_added = add<testing::IcpSumsCase>("1M samples, plane step", 1'000'000);
const bool icp_sums_point_added = add<testing::IcpSumsPointCase>("1M samples, Horn", 1'000'000);
const bool icp_sums_normals_added =
    add<testing::IcpSumsNormalsCase>("1M samples, plane step, normals given", 1'000'000);
}  // namespace hybrid::bench
