#pragma once
#include <cstdint>
#include <vector>

#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// The planes of faces, by column: of hundreds of faces few are near a point, and vectors tell which.
class FacePlanes {
 public:
  void add(const Plane& plane);

  // near[k] is 0 of planes farther than `reach_m` from the point, and of those whose normal's cosine with
  // this one is less than `least_cosine`; of all others, and where rounding might tell otherwise, 1.
  void mark_near(const Vec3& point, const Vec3& normal, double reach_m, double least_cosine,
                 std::vector<std::uint8_t>& near) const;

 private:
  std::vector<double> x_, y_, z_, offset_m_;
};

}  // namespace hybrid::stages
