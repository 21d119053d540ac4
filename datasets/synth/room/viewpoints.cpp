// Where the scanner, the photographer and the viewer stand, and the proxy they share a frame with.
#include <cmath>
#include <numbers>

#include "geometry/angles.hpp"
#include "geometry/random.hpp"
#include "room/room.hpp"

namespace synth {
namespace {

Vec3 at(const World& room, double x_share, double y_share, double z_m) {
  return {x_share * room.size.x(), y_share * room.size.y(), z_m};
}

std::vector<Camera> photograph_cameras(const World& room, const Options& options) {
  struct Corner {
    double x, y, z, to_x, to_y, to_z;  // x, y: shares of the room
  };
  constexpr Corner stands[6] = {{0.06, 0.10, 1.75, 0.62, 0.75, 1.55}, {0.94, 0.09, 1.70, 0.35, 0.72, 1.75},
                                {0.95, 0.92, 1.80, 0.38, 0.25, 1.50}, {0.07, 0.90, 1.75, 0.62, 0.22, 1.65},
                                {0.66, 0.07, 1.60, 0.53, 0.90, 1.95}, {0.40, 0.93, 1.65, 0.70, 0.12, 1.75}};
  std::vector<Camera> cameras;
  for (std::uint64_t k = 0; k < 6; ++k) {
    Random random(options.seed, purpose::photograph_pose, k);
    const Corner& s = stands[k];
    Camera camera = photograph_camera(k, options.preset, 75);
    camera.eye = at(room, s.x, s.y, s.z) + 0.04 * random.normal3();
    const Vec3 target = at(room, s.to_x, s.to_y, s.to_z) + 0.15 * random.normal3();
    camera.camera_from_world_rotation =
        look_at(camera.eye, target, Vec3::UnitZ(), 1.2 * kDegree * random.normal());
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<ScannerPose> scanner_poses(const World& room, std::uint64_t seed) {
  const auto pose = [&](const std::string& id, std::uint64_t index, double x, double y) {
    Random random(seed, purpose::scan_pose, index);
    ScannerPose result{id, Eigen::Isometry3d::Identity(), false};
    result.world_from_scan.translate(at(room, x, y, 1.5) +
                                     0.1 * random.normal3().cwiseProduct(Vec3(1, 1, 0.2)));
    const double tilt_x = kDegree * random.normal(), tilt_y = kDegree * random.normal();
    const double yaw = random.uniform(0, 2 * std::numbers::pi);
    result.world_from_scan.rotate(Eigen::AngleAxisd(tilt_x, Vec3::UnitX()) *
                                  Eigen::AngleAxisd(tilt_y, Vec3::UnitY()) *
                                  Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
    return result;
  };
  return {pose("west", 0, 0.25, 0.55), pose("east", 1, 0.78, 0.46)};
}

std::vector<View> views(const World& room, const std::vector<Camera>& photographs) {
  const Vec3 eye = at(room, 0.12, 0.24, 1.65), target = at(room, 0.62, 0.78, 1.60);
  std::vector<View> result = {{"proxy", "proxy", "", false, true, eye, target, {}},
                              {"proxy-textured", "proxy", "", true, false, eye, target, {}},
                              {"points", "scan", "", false, false, eye, target, {}},
                              {"both", "both", "", false, false, eye, target, {}},
                              {"both-textured", "both", "", true, false, eye, target, {}, true}};
  result.push_back(
      {"novel-2", "both", "", true, false, at(room, 0.91, 0.53, 1.75), at(room, 0.2, 0.40, 1.45), {}, true});
  const std::string& left_out = photographs[2].name;
  result.push_back({"leave-one-out", "both", left_out, true, false, {}, {}, {left_out}});
  return result;
}

}  // namespace

void place_viewpoints(World& room, const Options& options) {
  room.photographs = photograph_cameras(room, options);
  room.scanners = scanner_poses(room, options.seed);
  room.views = views(room, room.photographs);
}

void add_box_proxy(World& room) {
  // Vertex indices are the bits x, y, z (bit set = far side); faces towards the inside.
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner(k & 1 ? room.size.x() : 0, k & 2 ? room.size.y() : 0, k & 4 ? room.size.z() : 0);
    room.proxy.add_vertex(corner, (room.size / 2 - corner).cwiseSign());
  }
  room.proxy.add_face("floor", {0, 1, 3, 2});
  room.proxy.add_face("ceiling", {4, 6, 7, 5});
  room.proxy.add_face("wall-north", {2, 3, 7, 6});
  room.proxy.add_face("wall-east", {3, 1, 5, 7});
  room.proxy.add_face("wall-south", {1, 0, 4, 5});
  room.proxy.add_face("wall-west", {0, 2, 6, 4});
}

}  // namespace synth
