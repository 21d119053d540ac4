#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "shared/peer_report.hpp"
#include "shared/points_ply.hpp"
#include "shared/proxy_obj.hpp"

namespace hybrid::peers {

struct IcpInput {
  std::vector<PlyPoint> source;  // scan frame
  ProxyMesh proxy;               // world frame
  std::string proxy_file;
  Eigen::Matrix4d start;  // world_from_scan, off by 5 cm and 2 degrees
  std::string variant;
  int threads = 0;
};

struct IcpResult {
  Eigen::Matrix4d world_from_scan;
  int iterations = -1;  // not known
};

using IcpBody = std::function<IcpResult(const IcpInput&, Report&)>;

// The command line every registration answers: --source POINTS.ply --target PROXY.obj --start JOB.json
// [--variant V]
// [--threads N]. JOB.json holds `start`. Reads, times `body` (unless it set report.seconds itself), reports
// the pose.
int icp_main(int argc, char** argv, const std::string& package, const std::vector<std::string>& variants,
             const IcpBody& body);

}  // namespace hybrid::peers
