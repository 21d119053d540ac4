// Closed solids of free outline; all append to `mesh`, planes get the next free ids.
#pragma once
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/outline.hpp"

namespace synth {

inline constexpr double kSunk = 0.005;  // standing things reach into what carries them: no coplanar faces

// Where a slab's drawing lies: x = u, y = v; the front looks along u x v, the slab reaches `thickness` back.
struct Frame {
  Vec3 origin, u, v;
  Vec3 normal() const { return u.cross(v); }
  Vec3 at(const Vec2& p, double height = 0) const {
    return origin + p.x() * u + p.y() * v + height * normal();
  }
};

struct Hole {
  std::string name;  // its sides are called name-side-1, ...
  Outline outline;
  Material sides = Material::dressed_stone;
};

struct Slab {
  std::string
      name;  // front; name-back, name-side-1, ...: every straight side a plane, every arc one free surface
  Frame frame;
  Outline outline;
  double thickness_m = 0;
  Material front = Material::ashlar, back = Material::ashlar, sides = Material::ashlar;
  std::vector<Hole> holes = {};
};
void add_slab(Mesh&, const Slab&);

// Surfaces whose names start alike with either prefix and that lie in one plane get one plane id: one wall
// of two solids.
void share_planes(Mesh&, const std::string& prefix, const std::string& other_prefix);

// Turned on a vertical lathe: profile as (radius, height), from the axis to the axis, rising outside.
void add_turned(Mesh&, const std::string& name, Material, const Vec3& foot, const std::vector<Vec2>& profile,
                int slices);

// A profile (x: outwards in the drawing, y: in front of it) drawn along a path in the frame; open paths get
// ends. The profile is convex and counter-clockwise, seen along the path with "outwards" to the right.
void add_moulding(Mesh&, const std::string& name, Material, const Frame&, const std::vector<Vec2>& path,
                  bool closed, const std::vector<Vec2>& profile);

// A round tube along a path in space.
void add_tube(Mesh&, const std::string& name, Material, const std::vector<Vec3>& path, bool closed,
              double radius_m, int sides);

}  // namespace synth
