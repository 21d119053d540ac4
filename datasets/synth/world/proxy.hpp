#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "world/options.hpp"

namespace synth {

struct ProxyVertex {
  Vec3 position;  // without error
  Vec3 free;      // towards where the corner can be seen from, per axis +-1; zero: nobody would pick it
};

struct ProxyFace {
  std::string name;
  std::vector<std::uint32_t> ring;  // counter-clockwise seen from the free side
  Vec3 normal;                      // true, towards the free side
  double offset_m = 0;              // true: normal . x
  double error_m = 0;               // how far along its normal the face was moved
};

// What a person would model in a block modeller.
struct Proxy {
  std::vector<ProxyVertex> vertices;
  std::vector<Vec3> moved;  // the vertices as modelled: with the faces' errors
  std::vector<ProxyFace> faces;

  std::uint32_t add_vertex(const Vec3& position, const Vec3& free = Vec3::Zero());
  void add_face(const std::string& name, const std::vector<std::uint32_t>& ring);
};

// Moves whole faces, not single corners: the polygons stay planar, as a block modeller's are. A vertex goes
// the shortest way onto the moved planes of all its faces. Errors are cut at two standard deviations.
void move_faces(Proxy&, const Options&);

}  // namespace synth
