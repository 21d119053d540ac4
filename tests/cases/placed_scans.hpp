#pragma once
#include <memory>
#include <vector>

#include "cases/trial_room.hpp"
#include "device.hpp"
#include "geometry/angles.hpp"

namespace hybrid::testing {

// A room, two scans of it that have their poses, and a third.
struct PlacedScans {
  struct Seen {
    TrialScan scan;
    std::unique_ptr<stages::IcpScan> icp;
    Seen(const TrialRoom& room, std::uint32_t seed)
        : scan(scan_trial_room(queue(), room, seed, 1)), icp(icp_scan_of(queue(), scan, 20000)) {}
    const Pose& pose() const { return scan.world_from_scan; }
  };
  Seen a, b, scan;
  explicit PlacedScans(const char* kind, std::uint32_t seed)
      : PlacedScans(make_trial_room(kind, seed), seed) {}
  PlacedScans(const TrialRoom& room, std::uint32_t seed)
      : a(room, seed), b(room, seed + 300), scan(room, seed + 700) {}
  std::vector<stages::PlacedScan> placed() const {
    return {{a.icp.get(), a.pose()}, {b.icp.get(), b.pose()}};
  }
};

inline Pose shifted(const Pose& pose, const Vec3& by) {
  Pose moved = pose;
  moved.translation += by;
  return moved;
}

// Turned about the vertical through the point.
inline Pose turned(const Pose& pose, double deg, const Vec3& about) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(deg * kDegree, Vec3::UnitZ()));
  return {pose.scale, turn * pose.rotation, turn * (pose.translation - about) + about};
}

inline Vec3 middle(const RoomPlan& plan) {
  Vec3 sum = Vec3::Zero();
  for (const Vec2& corner : plan.footprint) sum += Vec3(corner.x(), corner.y(), 0);
  return sum / static_cast<double>(plan.footprint.size());
}

}  // namespace hybrid::testing
