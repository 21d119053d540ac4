#pragma once
#include <embree3/rtcore.h>

#include <optional>
#include <vector>

#include "geometry/mesh.hpp"

namespace synth {

struct Hit {
  double distance_m =
      0;  // along the unit direction; from the surface's equation in double, not Embree's float
  std::uint32_t surface = 0;
  Vec3 point, normal;          // normal: smooth on curved surfaces, towards the free side
  std::uint32_t triangle = 0;  // and where in it: weights of its second and third corner
  float second = 0, third = 0;
  Eigen::Vector2d coordinates = {0, 0};  // on free surfaces: texture coordinates in metres
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

  // What light does at panes of glass: solid things alone, the first pane alone.
  std::optional<Hit> nearest_solid(const Vec3& origin, const Vec3& unit_direction) const;
  std::optional<Hit> nearest_glass(const Vec3& origin, const Vec3& unit_direction) const;
  bool solid_blocks(const Vec3& from, const Vec3& unit_direction) const;

 private:
  struct Part {  // of the mesh: its solid or its glass triangles
    RTCScene scene = nullptr;
    std::vector<std::uint32_t> triangles;
  };
  Part make_part(bool glass) const;
  std::optional<Hit> nearest_in(const Part&, const Vec3& origin, const Vec3& unit_direction) const;

  const Mesh& mesh_;
  RTCDevice device_;
  Part solid_, glass_;
};

}  // namespace synth
