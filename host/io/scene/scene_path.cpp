#include "io/scene/scene_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "geometry/camera.hpp"

namespace hybrid::io {
namespace {

constexpr int kMostFrames = 100'000;

struct Stand {
  Vec3 eye, target;
};
using Curve = std::function<Stand(double)>;  // of 0 .. 1

Curve turntable(const SceneTable& table, const Vec3& up) {
  for (std::string_view key : {"eyes", "targets", "closed"})
    if (table.has(key)) table.fail_key(key, "belongs to key cameras, not to a turntable (centre, radius)");
  for (std::string_view key : {"centre", "radius"})
    if (!table.has(key)) table.fail_table("expected centre and radius, found no {}", key);
  const Vec3 centre = *table.point("centre");
  const double radius = *table.number("radius"), height = table.number("height").value_or(0);
  if (!(radius > 0)) table.fail_key("radius", "expected more than 0 m, found {}", radius);
  if (!(up.norm() > 0)) table.fail_key("up", "expected a direction, found {} {} {}", up.x(), up.y(), up.z());
  const double start = table.number("start_deg").value_or(0) * M_PI / 180,
               turn = table.number("turn_deg").value_or(360) * M_PI / 180;
  // Angles count from the world's X (Y where that is up), counterclockwise seen from above.
  const Vec3 axis = up.normalized();
  const Vec3 across = std::abs(axis.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 first = (across - across.dot(axis) * axis).normalized(), second = axis.cross(first);
  return [=](double at) {
    const double angle = start + at * turn;
    return Stand{centre + height * axis + radius * (std::cos(angle) * first + std::sin(angle) * second),
                 centre};
  };
}

std::vector<Vec3> key_points(const SceneTable& table, std::string_view key, std::size_t least) {
  std::vector<Vec3> points;
  for (const auto& point : table.points(key, 3, least)) points.emplace_back(point[0], point[1], point[2]);
  return points;
}

// Eye and target as one point, so that both reach their keys together.
using Six = Eigen::Matrix<double, 6, 1>;

// Centripetal Catmull-Rom spline (Barry and Goldman 1988; Yuksel, Schaefer, Keyser 2011) from the second to
// the third of four points, at 0 .. 1: unlike the uniform one it makes no loops where legs differ in length.
// The ends of an open path go straight on.
Six between(const std::array<Six, 4>& points, double share) {
  std::array<double, 4> knot{};
  for (std::size_t i = 1; i < 4; ++i)
    knot[i] = knot[i - 1] + std::max(1e-9, std::sqrt((points[i] - points[i - 1]).norm()));
  const double t = knot[1] + share * (knot[2] - knot[1]);
  const auto mix = [&](const Six& a, const Six& b, std::size_t from, std::size_t to) -> Six {
    return ((knot[to] - t) * a + (t - knot[from]) * b) / (knot[to] - knot[from]);
  };
  const Six a = mix(points[0], points[1], 0, 1), b = mix(points[1], points[2], 1, 2),
            c = mix(points[2], points[3], 2, 3);
  return mix(mix(a, b, 0, 2), mix(b, c, 1, 3), 1, 2);
}

Stand on_spline(const std::vector<Six>& keys, bool closed, double at) {
  const auto count = static_cast<std::ptrdiff_t>(keys.size());
  const std::ptrdiff_t pieces = closed ? count : count - 1;
  const auto piece = std::clamp(static_cast<std::ptrdiff_t>(at * static_cast<double>(pieces)),
                                std::ptrdiff_t{0}, pieces - 1);
  const auto key = [&](std::ptrdiff_t i) -> Six {
    if (closed) return keys[static_cast<std::size_t>((i + count) % count)];
    if (i < 0) return 2 * keys[0] - keys[1];
    if (i >= count) return 2 * keys[keys.size() - 1] - keys[keys.size() - 2];
    return keys[static_cast<std::size_t>(i)];
  };
  const Six point = between({key(piece - 1), key(piece), key(piece + 1), key(piece + 2)},
                            at * static_cast<double>(pieces) - static_cast<double>(piece));
  return {point.head<3>(), point.tail<3>()};
}

// The curve again, run through at constant speed of eye and target together.
Curve evenly(const Curve& curve) {
  constexpr int kSteps = 4096;
  std::vector<double> length{0};
  Stand before = curve(0);
  for (int i = 1; i <= kSteps; ++i) {
    const Stand here = curve(static_cast<double>(i) / kSteps);
    length.push_back(length.back() + (here.eye - before.eye).norm() + (here.target - before.target).norm());
    before = here;
  }
  return [curve, length](double at) {
    const double wanted = at * length.back();
    const auto above = std::upper_bound(length.begin() + 1, length.end() - 1, wanted);
    const double low = *(above - 1), high = *above;
    const double share = high > low ? std::clamp((wanted - low) / (high - low), 0.0, 1.0) : 0;
    return curve((static_cast<double>(above - length.begin() - 1) + share) / kSteps);
  };
}

Curve key_cameras(const SceneTable& table) {
  for (std::string_view key : {"radius", "height", "start_deg", "turn_deg"})
    if (table.has(key)) table.fail_key(key, "belongs to a turntable (centre, radius), not to key cameras");
  for (std::string_view key : {"eyes", "targets"})
    if (!table.has(key)) table.fail_table("expected eyes and targets, found no {}", key);
  const auto eyes = key_points(table, "eyes", 2), targets = key_points(table, "targets", 1);
  if (targets.size() != 1 && targets.size() != eyes.size())
    table.fail_key("targets", "expected one target, or one for each of the {} eyes, found {}", eyes.size(),
                   targets.size());
  std::vector<Six> keys(eyes.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] << eyes[i], targets[targets.size() == 1 ? 0 : i];
  const bool closed = table.flag("closed", false);
  return evenly([keys, closed](double at) { return on_spline(keys, closed, at); });
}

// A path that ends where it begins shows that place once.
bool returns(const SceneTable& table, bool turns) {
  if (!turns) return table.flag("closed", false);
  const double turn = std::abs(table.number("turn_deg").value_or(360));
  return turn > 0 && std::abs(std::remainder(turn, 360.0)) < 1e-9;
}

}  // namespace

const SceneTable::Names& scene_path_keys() {
  static const SceneTable::Names keys = {
      "name",   "frames", "size",   "fov_deg",   "up",       "show", "texture", "cameras", "leave_out",
      "centre", "radius", "height", "start_deg", "turn_deg", "eyes", "targets", "closed",  "projection"};
  return keys;
}

std::vector<SceneView> read_scene_path(const std::filesystem::path& file, const SceneTable& table) {
  SceneView common;
  common.line = table.line();
  table.required_text("name");
  common.path = *table.folder_name("name");
  if (common.path == "leave-one-out")
    table.fail_key("name", "\"leave-one-out\" is the folder of --leave-one-out; choose another name");
  common.up = table.point("up").value_or(common.up);
  read_view_options(table, common);
  read_view_projection(table, common);
  const int frames = table.index("frames").value_or(0);
  if (frames < 1 || frames > kMostFrames)
    table.fail_table("frames: expected from 1 to {}, found {}", kMostFrames, frames);
  const bool turns = table.has("centre");
  if (turns == (table.has("eyes") || table.has("targets")))
    table.fail_table("expected either centre and radius or eyes and targets, found {}",
                     turns ? "both" : "neither");
  const Curve curve = turns ? turntable(table, common.up) : key_cameras(table);
  const double last = returns(table, turns) ? frames : std::max(1, frames - 1);
  const auto digits = static_cast<int>(std::max<std::size_t>(4, std::to_string(frames - 1).size()));
  std::vector<SceneView> views;
  for (int frame = 0; frame < frames; ++frame) {
    SceneView view = common;
    view.name = fmt::format("{}/{:0{}}", common.path, frame, digits);
    const Stand stand = curve(frame / last);
    view.eye = stand.eye, view.target = stand.target;
    with_context(fmt::format("{}:{}: frame {}", file.string(), view.line, frame), [&] { camera_of(view); });
    views.push_back(view);
  }
  return views;
}

}  // namespace hybrid::io
