#pragma once
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
  // Of the last solve(). Measured minus predicted range at the ray of `point`, NaN where the ray misses the
  // plane.
  double residual_m(const Vec3& point) const;
  // Variance of that prediction, in units of the noise's variance.
  double prediction_variance(const Vec3& point) const;
  // |normal . ray|.
  double cosine(const Vec3& point) const;
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
  Mat3 inverse_ = Mat3::Zero();
  double squares_m2_ = 0;
};

}  // namespace hybrid::stages
