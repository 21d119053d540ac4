#pragma once
#include <numbers>

namespace synth {

inline constexpr double kDegree = std::numbers::pi / 180;  // rad

}  // namespace synth
