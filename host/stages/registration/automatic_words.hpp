#pragma once
#include <string>

#include "geometry/pose.hpp"

namespace hybrid::stages {

// "(9.40, 3.67, 1.48)"
std::string vector_in_words(const Vec3& v);

// What takes the scan from one pose to another: "turned by 180 degrees about the vertical, the scanner moved
// by 5.31 m to (9.40, 3.67, 1.48)".
std::string motion_in_words(const Pose& from, const Pose& to);

}  // namespace hybrid::stages
