#include "stages/registration/face_planes.hpp"

#include <cmath>

#include "core/cpu_clones.hpp"

namespace hybrid::stages {
namespace {

constexpr double kRounding = 1e-9;

HYBRID_CPU_CLONES
void mark(std::size_t count, const double* x, const double* y, const double* z, const double* offset,
          const double* point, const double* normal, double reach, double least_cosine, std::uint8_t* near) {
  for (std::size_t k = 0; k < count; ++k) {
    const double height = x[k] * point[0] + y[k] * point[1] + z[k] * point[2] - offset[k];
    const double cosine = x[k] * normal[0] + y[k] * normal[1] + z[k] * normal[2];
    near[k] = static_cast<std::uint8_t>((std::abs(height) < reach) & (cosine >= least_cosine));
  }
}

}  // namespace

void FacePlanes::add(const Plane& plane) {
  x_.push_back(plane.normal.x());
  y_.push_back(plane.normal.y());
  z_.push_back(plane.normal.z());
  offset_m_.push_back(plane.offset_m);
}

void FacePlanes::mark_near(const Vec3& point, const Vec3& normal, double reach_m, double least_cosine,
                           std::vector<std::uint8_t>& near) const {
  near.resize(x_.size());
  mark(x_.size(), x_.data(), y_.data(), z_.data(), offset_m_.data(), point.data(), normal.data(),
       reach_m + kRounding * (1 + reach_m), least_cosine - kRounding, near.data());
}

}  // namespace hybrid::stages
