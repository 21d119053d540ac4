#pragma once
#include <string>

#include "stages/registration/automatic.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::stages {

struct PoseEvidence {
  SightShares shares;         // of the planar area, under the pose
  std::string contradiction;  // what speaks against the pose, in words; "" = it may be right
};

// Judges a pose that ICP found from a start nobody searched for. Refused is what a proxy that lacks walls, or
// whose faces are off by centimetres (a wall by 15), cannot explain: of the planar area that the model says
// anything of less than `least_support` on its faces, what lies in front of them (furniture) counted half;
// more than `most_through` seen through them, or more than a fifth where the pose is undetermined along some
// direction; hardly any on them at all; robust residuals of twice `clear_m`; a model a hundred times too
// large. Distances are the scan's where the scale is free. Kernel: ray_cast.
PoseEvidence judge_pose(device::Queue& queue, const ScanEvidence& scan, const ProxyModel& model,
                        const Registration& icp, const IcpOptions& icp_options,
                        const AutomaticOptions& options);

}  // namespace hybrid::stages
