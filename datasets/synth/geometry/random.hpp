#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace synth {

// splitmix64's finaliser: a bijection with full avalanche.
inline std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// Counter-based: every draw is a function of (seed, purpose, item, counter) alone, so the bytes written do
// not depend on the number of threads or on the order in which rays are traced.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t purpose, std::uint64_t item = 0)
      : key_(mix(mix(mix(seed) ^ purpose) ^ item)) {}

  std::uint64_t bits() { return mix(key_ ^ mix(counter_++)); }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  // [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() {  // Box-Muller; 1 - u keeps the logarithm finite
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  Eigen::Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

// One number per use, so that no two uses share a stream.
namespace purpose {
enum : std::uint64_t {
  layout = 1,
  proxy,
  photograph_pose,
  scan_pose,
  scan_column,
  landmarks,
  pixel,
  sensor,
  optics,
  develop,
  camera_error
};
}

}  // namespace synth
