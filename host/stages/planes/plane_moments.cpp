#include "stages/planes/plane_moments.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

// Keeps tests by sigmas meaningful on noise-free data.
constexpr double kLeastNoise_m = 1e-5;

double noise_m(const PlaneFit& fit) {
  return std::max(fit.rms_m, kLeastNoise_m);
}

}  // namespace

void PlaneMoments::merge(const PlaneMoments& other) {
  if (other.weight <= 0) return;
  const double total = weight + other.weight;
  const Vec3 step = other.mean - mean;
  scatter += other.scatter + (weight * other.weight / total) * step * step.transpose();
  mean += (other.weight / total) * step;
  weight = total;
}

Vec3 PlaneFit::in_frame(const Vec3& point) const {
  const Vec3 arm = point - centroid;
  return {arm.dot(axis[0]), arm.dot(axis[1]), arm.dot(plane.normal)};
}

double PlaneFit::offset_sigma_m(const Vec3& point) const {
  const Vec3 arm = point - centroid;
  double variance = 1 / weight;
  for (int i = 0; i < 2; ++i) {
    const double along = arm.dot(axis[static_cast<std::size_t>(i)]);
    variance += along * along / std::max(spread[static_cast<std::size_t>(i)], 1e-12);
  }
  return noise_m(*this) * std::sqrt(variance);
}

double PlaneFit::normal_sigma_rad() const {
  return noise_m(*this) / std::sqrt(std::max(spread[0], 1e-12));
}

PlaneFit fit_plane(const PlaneMoments& moments) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(moments.scatter);
  PlaneFit fit;
  fit.centroid = moments.mean;
  fit.weight = moments.weight;
  fit.plane.normal = solver.eigenvectors().col(0).normalized();
  fit.plane.offset_m = fit.plane.normal.dot(fit.centroid);
  face_scanner(fit.plane);
  fit.axis = {solver.eigenvectors().col(1), solver.eigenvectors().col(2)};
  fit.spread = {std::max(solver.eigenvalues()[1], 0.0), std::max(solver.eigenvalues()[2], 0.0)};
  fit.rms_m = std::sqrt(std::max(solver.eigenvalues()[0], 0.0) / fit.weight);
  return fit;
}

void face_scanner(Plane& plane) {
  if (plane.offset_m <= 0) return;
  plane.normal = -plane.normal;
  plane.offset_m = -plane.offset_m;
}

}  // namespace hybrid::stages
