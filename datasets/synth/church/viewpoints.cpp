// Where the scanner, the photographer and the viewer stand.
#include <cmath>
#include <numbers>

#include "church/church.hpp"
#include "geometry/angles.hpp"

namespace synth {
namespace {

constexpr double kExposureOutside = 1.0, kExposureInside = 4.2;  // exposures

struct Stand {
  Vec3 eye, target;
  bool outside;
};

std::vector<Stand> stands(const Plan& p) {
  const double from = p.wall, to = p.wall + p.length, w = p.half_width;
  std::vector<Stand> all = {{{-7.5, -12.5, 1.8}, {0.3, 0, 5.4}, true},
                            {{7.0, -13.0, 1.7}, {-0.3, 0, 5.2}, true},
                            {{0.4, -8.2, 1.7}, {0.0, 0, 3.6}, true},
                            {{0.6, from + 0.7, 2.1}, {-0.1, to, 2.7}, false},
                            {{-w + 0.7, from + 1.0, 1.9}, {1.6, to - 4, 2.1}, false},
                            {{w - 0.7, to - 2.0, 2.2}, {-1.4, from + 4, 2.4}, false},
                            {{-0.8, to - 3.2, 1.9}, {0.4, from, 3.6}, false},
                            {{p.arcade + 1.2, from + 0.8, 1.8}, {p.arcade + 0.6, to, 2.5}, false},
                            {{-p.arcade - 1.1, to - 1.0, 1.8}, {-p.arcade - 0.2, from, 2.6}, false},
                            {{-4.2, -8.0, 1.6}, {2.4, 0, 2.6}, true},
                            {{4.9, -7.6, 1.6}, {-2.0, 0, 2.8}, true},
                            {{-0.6, from + 0.45 * p.length, 2.0}, {1.5, to, 3.8}, false}};
  return all;
}

std::vector<Camera> photographs(const Plan& plan, const Options& options) {
  std::vector<Camera> cameras;
  const std::vector<Stand> all = stands(plan);
  // The small presets do with the first ten.
  const std::size_t count = options.preset.name == "full" ? all.size() : all.size() - 2;
  for (std::size_t k = 0; k < count; ++k) {
    Random random(options.seed, purpose::photograph_pose, k);
    Camera camera = photograph_camera(k, options.preset, 78);
    camera.exposure = all[k].outside ? kExposureOutside : kExposureInside;
    camera.eye = all[k].eye + 0.05 * random.normal3();
    const Vec3 target = all[k].target + 0.12 * random.normal3();
    camera.camera_from_world_rotation =
        look_at(camera.eye, target, Vec3::UnitZ(), 1.2 * kDegree * random.normal());
    cameras.push_back(camera);
  }
  return cameras;
}

struct Station {
  std::string id;
  Vec3 place;
  bool grid;
};

// In the order in which a survey takes them: the three of the small scenes; what ties them together (before
// the door; the corner, which sees front and side wall; an aisle, which sees the other through the arcades);
// then round the church, near and far in turn, and along its aisles, so that the first n are a survey as
// well; last, in the open half of the door, what sees inside and outside.
std::vector<Station> stations(const Plan& p) {
  const double from = p.wall, to = p.wall + p.length, back = p.outer_length(), high = p.floor + 1.6;
  const double aisle = (p.arcade + p.arcade_thick / 2 + p.half_width) / 2;
  const double near = p.outer_half() + 3, far = p.outer_half() + 7.5;
  const auto along = [&](double share) { return from + share * p.length; };
  return {{"front", {-1.2, -7.2, 1.6}, false},
          {"nave", {0.15, from + 1.6, high}, false},
          {"chancel", {-0.2, to - 4.3, high}, true},
          {"porch", {0.45, -1.4, 1.6}, false},
          {"corner", {p.outer_half() + 4.5, -4.5, 1.6}, false},
          {"aisle", {aisle, along(0.45), high}, true},
          {"north", {-near, along(0.3), 1.6}, false},
          {"north-aisle", {-aisle, along(0.35), high}, false},
          {"south", {near, along(0.7), 1.6}, true},
          {"altar", {-1.6, to - 2.0, high + 0.32}, false},
          {"east", {0.6, back + 4.0, 1.6}, false},
          {"crossing", {0.1, along(0.4), high}, true},
          {"north-corner", {-p.outer_half() - 4.5, -5.0, 1.6}, false},
          {"south-aisle-east", {aisle, along(0.85), high}, false},
          {"south-far", {far, along(0.3), 1.6}, false},
          {"north-aisle-east", {-aisle, along(0.85), high}, true},
          {"north-east", {-p.outer_half() - 3.5, back + 4.5, 1.6}, false},
          {"south-aisle-west", {aisle, along(0.24), high}, false},
          {"front-far", {3.2, -13.5, 1.6}, true},
          {"north-aisle-middle", {-aisle, along(0.6), high}, false},
          {"south-east", {p.outer_half() + 3.5, back + 4.5, 1.6}, false},
          {"north-far", {-far, along(0.75), 1.6}, false},
          {"nave-middle", {-0.1, along(0.22), high}, false},
          {"front-south", {3.6, -6.2, 1.6}, true},
          {"doorway", {0.45, p.wall / 2, high}, false}};
}

ScannerPose scanner(const Station& station, std::uint64_t index, std::uint64_t seed) {
  Random random(seed, purpose::scan_pose, index);
  ScannerPose result{station.id, Eigen::Isometry3d::Identity(), station.grid};
  result.world_from_scan.translate(station.place + 0.08 * random.normal3().cwiseProduct(Vec3(1, 1, 0.3)));
  const double tilt_x = kDegree * random.normal(), tilt_y = kDegree * random.normal();
  const double yaw = random.uniform(0, 2 * std::numbers::pi);
  result.world_from_scan.rotate(Eigen::AngleAxisd(tilt_x, Vec3::UnitX()) *
                                Eigen::AngleAxisd(tilt_y, Vec3::UnitY()) *
                                Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
  return result;
}

}  // namespace

void place_church_viewpoints(World& world, const Plan& plan, const Options& options) {
  const double from = plan.wall, to = plan.wall + plan.length;
  world.photographs = photographs(plan, options);
  world.scanners.clear();
  const std::vector<Station> all = stations(plan);
  for (std::size_t k = 0; k < static_cast<std::size_t>(options.scans); ++k)
    world.scanners.push_back(scanner(all.at(k), k, options.seed));
  const Vec3 eye(-4.6, -11.5, 1.9), target(0.5, 0, 4.7);
  const Vec3 nave(-0.4, from + 0.9, 2.2), altar(0.3, to, 2.8);
  const std::string out = world.photographs[1].name, in = world.photographs[4].name;
  const double dark = kExposureInside;
  world.views = {{"front-proxy", "proxy", "", false, true, eye, target, {}, false, 1},
                 {"front-points", "scan", "", false, false, eye, target, {}, false, 1},
                 {"front-textured", "both", "", true, false, eye, target, {}, true, 1},
                 {"nave-points", "scan", "", false, false, nave, altar, {}, false, dark},
                 {"nave-textured", "both", "", true, false, nave, altar, {}, true, dark},
                 {"portal-textured", "both", "", true, false, {1.6, -5.6, 1.7}, {-0.1, 0, 2.5}, {}, true, 1},
                 {"leave-one-out-front", "both", out, true, false, {}, {}, {out}, false, 1},
                 {"leave-one-out-nave", "both", in, true, false, {}, {}, {in}, false, dark}};
}

}  // namespace synth
