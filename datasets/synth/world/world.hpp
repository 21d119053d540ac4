// What every synthetic scene consists of: made by room/ and church/, traced by trace/, written by write/.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "trace/camera.hpp"
#include "world/options.hpp"
#include "world/proxy.hpp"

namespace synth {

enum class Picture { chart, star, landscape, blocks, sign, notice, plaque, numbers };

// Something painted or pasted flat on a surface, in the surface's texture coordinates (metres).
struct Decor {
  Picture picture;
  double left_m, bottom_m, width_m, height_m;
  std::string text;
};

// A rectangle that emits evenly to the side of its normal (u x v).
struct AreaLight {
  Vec3 centre, half_u, half_v;
  Eigen::Array3d radiance;
  bool lamp = false;  // a bright patch of the ceiling's own pattern
};

struct Sun {
  Vec3 towards;               // unit
  Eigen::Array3d irradiance;  // over pi, on a surface that faces it
};

struct Clutter {
  std::string name, kind;
  Vec3 low, high;  // bounding box, world
};

// Where the proxy's face has no counterpart: a ring on the face's plane, counter-clockwise seen from the
// face's free side, and how deep the recess behind it is.
struct Opening {
  std::string name, face;
  double depth_m = 0;
  std::vector<Vec3> ring;
};

struct ScannerPose {
  std::string id;
  Eigen::Isometry3d world_from_scan;
  bool grid = false;  // PTX: every column holds the same elevations, absent samples stay as (0, 0, 0)
};

struct View {
  std::string name, show, photograph;  // photograph: empty for a free eye
  bool texture = false, cameras = false;
  Vec3 eye, target;
  std::vector<std::string> leave_out;
  bool held_out = false;  // its truth is rendered
  double exposure = 1;
};
inline constexpr double kViewFovDeg = 60;  // vertical

struct Box {
  Vec3 low, high;
  bool contains(const Vec3& p) const { return (p - low).minCoeff() >= 0 && (high - p).minCoeff() >= 0; }
};

struct World {
  std::string kind;  // room | church
  Vec3 size;         // of what the kind is named after
  Mesh mesh;
  std::vector<Opening> openings;
  std::vector<std::vector<Decor>> decor_of_surface;  // parallel to mesh.surfaces
  std::vector<AreaLight> lights;
  std::optional<Sun> sun;       // with it: a sky, and indirect light gathered by tracing
  std::optional<Box> interior;  // where the sky's light comes through glass only
  std::vector<Clutter> clutter;
  Eigen::Array2d rug_low = {0, 0}, rug_high = {0, 0};  // on a floor of planks
  Proxy proxy;
  std::vector<ScannerPose> scanners;
  std::uint64_t first_scanner =
      0;  // which of the whole scene's scanners[0] is: its draws of chance hang on it
  std::vector<Camera> photographs;
  std::vector<View> views;
};

// Hangs a picture on every surface of that name.
void hang(World&, const std::string& surface, const Decor&);
// Takes out all other scans, all photographs and all views; the scan keeps its bytes. Throws
// std::invalid_argument when there is none of that name.
void keep_only_scan(World&, const std::string& id);
// Photographs through a perfect lens: E57's pinhole images know no other.
void remove_distortion(World&);
// Adds the bounding box of the vertices from `first_vertex` on.
void note_clutter(World&, const std::string& name, const std::string& kind, std::size_t first_vertex);

}  // namespace synth
