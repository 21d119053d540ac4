#pragma once
#include <cmath>
#include <limits>

#include "geometry/plane.hpp"

namespace hybrid::stages {

// Least-squares plane along the rays, for range noise of 1 m: m = normal / offset minimises
// sum (r (1 - m . p))^2, a linear system of three unknowns. Samples come one by one; the inverse of the
// matrix gives what a prediction is worth.
class RayPlane {
 public:
  // `around` is near all points that will be added: the system is set up in a frame that looks there, where
  // it keeps its digits however close together they are.
  explicit RayPlane(const Vec3& around);

  void add(const Vec3& point);
  // False when the samples fix no plane (fewer than 3, in line, or through the scanner).
  bool solve();

  std::size_t samples() const { return samples_; }
  // Of the last solve(), at the ray of `point`, which is `range_m` away. Measured minus predicted range, NaN
  // where the ray misses the plane; |normal . ray|.
  struct At {
    double residual_m, cosine;
  };
  At at(const Vec3& point, double range_m) const {
    const double reached = m_.dot(point);  // measured over predicted range
    return {reached > 0 ? range_m * (reached - 1) / reached : std::numeric_limits<double>::quiet_NaN(),
            std::abs(reached) / (length_ * range_m)};
  }
  // Measured over predicted range; 1 over the length of m.
  double reached(const Vec3& point) const { return m_.dot(point); }
  double inverse_length() const { return inverse_length_; }
  // Variance of that prediction, in units of the noise's variance.
  double prediction_variance(const Vec3& point) const {
    return point.squaredNorm() * point.dot(inverse_ * point);
  }
  // Sum of the squared residuals of the samples added, m2.
  double squares_m2() const { return squares_m2_; }
  // Normal towards the scanner.
  Plane plane() const;

 private:
  Mat3 frame_;  // rows: towards `around`, and two across
  std::size_t samples_ = 0;
  Mat3 matrix_ = Mat3::Zero();
  Vec3 right_ = Vec3::Zero();
  double constant_ = 0;
  Vec3 m_ = Vec3::Zero();
  double length_ = 0, inverse_length_ = 0;  // of m
  Mat3 inverse_ = Mat3::Zero();
  double squares_m2_ = 0;
};

}  // namespace hybrid::stages
