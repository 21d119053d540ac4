#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hybrid {

// Double on the host for poses and world coordinates; float for the millions of samples, metres from a local
// origin.
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec3f = Eigen::Vector3f;

}  // namespace hybrid
