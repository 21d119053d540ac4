#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/shapes.hpp"
#include "trace/camera.hpp"

namespace synth {

struct Preset {
  std::string name;
  int scan_columns, scan_rows;
  int photograph_width_px, photograph_height_px;
  int view_width_px, view_height_px;
  int truth_view_samples_per_side;
};

struct RoomOptions {
  std::uint64_t seed = 1;
  Preset preset;
  double noise_m = 0.002;  // standard deviation along the ray
  double dropout_share = 0.02;
  double proxy_error_m = 0;  // standard deviation of each proxy face's displacement along its normal
};

enum class Picture { chart, star, landscape, blocks, sign };

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
};

struct Clutter {
  std::string name, kind;
  Vec3 low, high;  // bounding box, world
};

struct Room {
  Vec3 size;
  Mesh mesh;
  std::vector<Recess> recesses;
  std::vector<std::vector<Decor>> decor_of_surface;  // parallel to mesh.surfaces
  std::vector<AreaLight> lights;
  std::vector<Clutter> clutter;
  Eigen::Array2d rug_low, rug_high;  // on the floor
};

struct ScannerPose {
  std::string id;
  Eigen::Isometry3d world_from_scan;
};

struct View {
  std::string name, show, photograph;  // photograph: empty for a free eye
  bool texture = false, cameras = false;
  Vec3 eye, target;
  std::vector<std::string> leave_out;
};
inline constexpr double kViewFovDeg = 60;  // vertical

Room build_room(std::uint64_t seed);
void hang_decor(Room& room);  // after the mesh is complete

std::vector<Camera> photograph_cameras(const Room&, const RoomOptions&);
std::vector<ScannerPose> scanner_poses(const Room&, std::uint64_t seed);
std::vector<View> views(const Room&, const std::vector<Camera>& photographs);

// The box a person would model: 8 vertices, in the order of the bits x, y, z (bit set = far side).
std::vector<Vec3> proxy_vertices(const Room&, const RoomOptions&);

struct Summary {
  std::string json;
  std::string text;
};
Summary generate_room(const RoomOptions&, const std::string& folder);

}  // namespace synth
