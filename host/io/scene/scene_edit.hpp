#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid::io {

class SceneTable;

// A face of the model file: its place in the file, or the name of a face, group, object or material.
struct SceneFaces {
  int line = 0;
  std::variant<int, std::string> which;
};

// A polygon to cut out of one face.
struct SceneHole {
  int line = 0;
  SceneFaces face;
  std::vector<Vec2> on_face;  // face coordinates (FaceFrame), or
  std::vector<Vec3> world;    // points of the face's plane
};

// Scan points to drop: those inside (or outside) one shape.
struct SceneClip {
  int line = 0;
  std::string scan;            // id; empty: every scan
  bool keep_inside = false;    // else outside is kept
  bool in_scan_frame = false;  // else the shape is in the world
  struct Box {
    Vec3 low, high;
  };
  struct HalfSpace {  // inside: normal . x <= offset
    Vec3 normal;
    double offset_m;
  };
  struct Prism {  // a polygon of x, y from z low to high
    std::vector<Vec2> polygon;
    double low, high;
  };
  std::variant<Box, HalfSpace, Prism> shape;
};

// An area of a range image to move along its rays.
struct SceneDepthEdit {
  int line = 0;
  std::string scan;
  std::vector<std::array<int, 2>> polygon;  // rows and columns of range.exr
  double by_m = 0;                          // away from the scanner positive
};

// [edit] of the scene file but its options: what is done, in the file's order, to model and scans.
struct SceneEdits {
  std::vector<SceneFaces> remove_faces;
  std::vector<SceneHole> holes;
  std::vector<SceneClip> clips;
  std::vector<SceneDepthEdit> depths;
  bool moves_depths_of(const std::string& scan) const {
    return std::any_of(depths.begin(), depths.end(),
                       [&](const SceneDepthEdit& edit) { return edit.scan == scan; });
  }
  bool any() const { return !remove_faces.empty() || !holes.empty() || !clips.empty() || !depths.empty(); }
};

// The keys of [edit] that are read here; the others are options.
const std::vector<std::string_view>& scene_edit_keys();
// Throws ErrorKind::input naming file, line and key. That faces and scans exist is checked where they are
// known.
SceneEdits read_scene_edits(const SceneTable& edit);

}  // namespace hybrid::io
