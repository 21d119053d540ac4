#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>

namespace hybrid {

// Double on the host for poses and world coordinates; float for the millions of samples, metres from a local
// origin.
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec3f = Eigen::Vector3f;

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();  // coordinates that were not measured
// Floats so far from the origin still have a tenth of a millimetre.
inline constexpr double kFarFromOrigin_m = 1000;

// As a record's three floats.
inline void store(const Vec3& v, float* to) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v(k));
}

}  // namespace hybrid
