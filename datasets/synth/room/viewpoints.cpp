// Where the scanner, the photographer and the viewer stand, and the proxy they share a frame with.
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "room/room.hpp"

namespace synth {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Vec3 at(const Room& room, double x_share, double y_share, double z_m) {
  return {x_share * room.size.x(), y_share * room.size.y(), z_m};
}

}  // namespace

std::vector<Camera> photograph_cameras(const Room& room, const RoomOptions& options) {
  struct Stand {
    double x, y, z, to_x, to_y, to_z;  // x, y: shares of the room
  };
  constexpr Stand stands[6] = {{0.06, 0.10, 1.75, 0.62, 0.75, 1.55}, {0.94, 0.09, 1.70, 0.35, 0.72, 1.75},
                               {0.95, 0.92, 1.80, 0.38, 0.25, 1.50}, {0.07, 0.90, 1.75, 0.62, 0.22, 1.65},
                               {0.66, 0.07, 1.60, 0.53, 0.90, 1.95}, {0.40, 0.93, 1.65, 0.70, 0.12, 1.75}};
  std::vector<Camera> cameras;
  for (std::uint64_t k = 0; k < 6; ++k) {
    Random random(options.seed, purpose::photograph_pose, k);
    const Stand& s = stands[k];
    Camera camera;
    camera.name = "00" + std::to_string(k) + ".jpg";
    camera.width_px = options.preset.photograph_width_px;
    camera.height_px = options.preset.photograph_height_px;
    camera.focal_px = camera.width_px / 2.0 / std::tan(37.5 * kDegree);
    camera.centre_x_px = camera.width_px * 0.5035;  // a real lens is not centred
    camera.centre_y_px = camera.height_px * 0.4970;
    camera.k1 = -0.06;
    camera.k2 = 0.02;
    camera.eye = at(room, s.x, s.y, s.z) + 0.04 * random.normal3();
    const Vec3 target = at(room, s.to_x, s.to_y, s.to_z) + 0.15 * random.normal3();
    camera.camera_from_world_rotation =
        look_at(camera.eye, target, Vec3::UnitZ(), 1.2 * kDegree * random.normal());
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<ScannerPose> scanner_poses(const Room& room, std::uint64_t seed) {
  const auto pose = [&](const std::string& id, std::uint64_t index, double x, double y) {
    Random random(seed, purpose::scan_pose, index);
    ScannerPose result{id, Eigen::Isometry3d::Identity()};
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

std::vector<View> views(const Room& room, const std::vector<Camera>& photographs) {
  const Vec3 eye = at(room, 0.12, 0.24, 1.65), target = at(room, 0.62, 0.78, 1.60);
  std::vector<View> result = {{"proxy", "proxy", "", false, true, eye, target, {}},
                              {"proxy-textured", "proxy", "", true, false, eye, target, {}},
                              {"points", "scan", "", false, false, eye, target, {}},
                              {"both", "both", "", false, false, eye, target, {}},
                              {"both-textured", "both", "", true, false, eye, target, {}}};
  result.push_back(
      {"novel-2", "both", "", true, false, at(room, 0.91, 0.53, 1.75), at(room, 0.2, 0.40, 1.45), {}});
  const std::string& left_out = photographs[2].name;
  result.push_back({"leave-one-out", "both", left_out, true, false, {}, {}, {left_out}});
  return result;
}

std::vector<Vec3> proxy_vertices(const Room& room, const RoomOptions& options) {
  // Whole faces move, not single corners: the polygons stay planar, as a block modeller's are.
  Random random(options.seed, purpose::proxy);
  Vec3 low = Vec3::Zero(), high = room.size;
  low += options.proxy_error_m * random.normal3();
  high += options.proxy_error_m * random.normal3();
  std::vector<Vec3> vertices;
  for (int k = 0; k < 8; ++k)
    vertices.push_back({k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), k & 4 ? high.z() : low.z()});
  return vertices;
}

}  // namespace synth
