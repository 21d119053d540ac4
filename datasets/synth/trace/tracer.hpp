#pragma once
#include <embree3/rtcore.h>

#include <optional>

#include "geometry/mesh.hpp"

namespace synth {

struct Hit {
  double distance_m =
      0;  // along the unit direction; from the surface's equation in double, not Embree's float
  std::uint32_t surface = 0;
  Vec3 point, normal;  // normal: smooth on curved surfaces, towards the free side
};

// Nearest hits and visibility on the true mesh. Thread safe.
class Tracer {
 public:
  explicit Tracer(const Mesh& mesh);  // keeps a reference
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  std::optional<Hit> nearest(const Vec3& origin, const Vec3& unit_direction) const;
  bool sees(const Vec3& from, const Vec3& to) const;  // both ends shrunk by a millimetre

 private:
  const Mesh& mesh_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace synth
