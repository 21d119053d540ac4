#include "cases/trial_room.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/closest_point_case.hpp"
#include "lib/random.h"
#include "shared/params_ray_cast.h"
#include "stages/rendering/bvh.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::testing {
namespace {

constexpr double kPi = std::numbers::pi;

std::uint32_t add_vertex(PolygonModel& model, const Vec3& v) {
  for (std::size_t k = 0; k < model.vertices.size(); ++k)
    if ((model.vertices[k] - v).norm() < 1e-9) return static_cast<std::uint32_t>(k);
  model.vertices.push_back(v);
  return static_cast<std::uint32_t>(model.vertices.size() - 1);
}

std::vector<std::uint32_t> ring_of(PolygonModel& model, const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> ring;
  for (const Vec3& p : points) ring.push_back(add_vertex(model, p));
  return ring;
}

// The wall over one side, its recesses as holes, and the recesses' faces.
void add_wall(PolygonModel& model, const RoomPlan& plan, std::size_t side) {
  const Vec2 a = plan.footprint[side], b = plan.footprint[(side + 1) % plan.footprint.size()];
  const Vec2 along = (b - a).normalized(), out(along.y(), -along.x());
  const auto at = [&](double s, double z, double depth) {
    const Vec2 p = a + s * along + depth * out;
    return Vec3(p.x(), p.y(), z);
  };
  const double length = (b - a).norm();
  // Seen from inside (the left of the side) counter-clockwise is from b to a.
  Face wall{
      "wall-" + std::to_string(side),
      ring_of(model, {at(length, 0, 0), at(0, 0, 0), at(0, plan.height_m, 0), at(length, plan.height_m, 0)}),
      {}};
  std::vector<Face> inner;
  for (const Recess& r : plan.recesses) {
    if (r.side != side) continue;
    const double s[2] = {r.from_m, r.to_m}, z[2] = {r.low_m, r.high_m}, d = r.depth_m;
    wall.holes.push_back(
        ring_of(model, {at(s[0], z[0], 0), at(s[1], z[0], 0), at(s[1], z[1], 0), at(s[0], z[1], 0)}));
    const auto face = [&](const char* name, const std::vector<Vec3>& points) {
      inner.push_back({wall.name + name, ring_of(model, points), {}});
    };
    face("-back", {at(s[1], z[0], d), at(s[0], z[0], d), at(s[0], z[1], d), at(s[1], z[1], d)});
    face("-sill", {at(s[1], z[0], 0), at(s[0], z[0], 0), at(s[0], z[0], d), at(s[1], z[0], d)});
    face("-head", {at(s[1], z[1], d), at(s[0], z[1], d), at(s[0], z[1], 0), at(s[1], z[1], 0)});
    face("-jamb-a", {at(s[0], z[0], d), at(s[0], z[0], 0), at(s[0], z[1], 0), at(s[0], z[1], d)});
    face("-jamb-b", {at(s[1], z[0], 0), at(s[1], z[0], d), at(s[1], z[1], d), at(s[1], z[1], 0)});
  }
  model.faces.push_back(wall);
  model.faces.insert(model.faces.end(), inner.begin(), inner.end());
}

std::vector<Vec2> footprint_of(const std::string& kind, Draw& draw) {
  const double x = draw.within(5, 12), y = draw.within(3.5, 8);
  if (kind == "ell") {
    const double cx = x * draw.within(0.35, 0.65), cy = y * draw.within(0.35, 0.65);
    return {{0, 0}, {x, 0}, {x, cy}, {cx, cy}, {cx, y}, {0, y}};
  }
  if (kind == "oblique")
    return {{0, 0},
            {x, draw.within(0.3, 1)},
            {x - draw.within(0.6, 1.5), y},
            {draw.within(0.1, 0.5), y + draw.within(-1.2, -0.5)}};
  return {{0, 0}, {x, 0}, {x, y}, {0, y}};
}

// Recesses of one room lie in different thirds of its walls, so that none overlap.
class Slots {
 public:
  Slots(const RoomPlan& plan, Draw& draw) : plan_(plan), draw_(draw), used_(3 * plan.footprint.size()) {}

  Recess recess(double least_depth, double most_depth) {
    std::size_t slot = 0;
    do slot = static_cast<std::size_t>(draw_.below(static_cast<int>(used_.size())));
    while (used_[slot] && std::count(used_.begin(), used_.end(), false) > 0);
    used_[slot] = true;
    Recess r;
    r.side = slot / 3;
    const Vec2 side = plan_.footprint[(r.side + 1) % plan_.footprint.size()] - plan_.footprint[r.side];
    const double third = side.norm() / 3, start = third * static_cast<double>(slot % 3);
    const double width = third * draw_.within(0.45, 0.8);
    r.from_m = start + draw_.within(0.05, 0.95) * (third - width - 0.1) + 0.05;
    r.to_m = r.from_m + width;
    const bool door = draw_.below(2) == 0;
    r.low_m = door ? 0.1 : draw_.within(0.5, 1);
    r.high_m = draw_.within(0.7, 0.9) * plan_.height_m;
    r.depth_m = draw_.within(least_depth, most_depth);
    return r;
  }

 private:
  const RoomPlan& plan_;
  Draw& draw_;
  std::vector<bool> used_;
};

bool inside(const std::vector<Vec2>& ring, const Vec2& p) {
  bool in = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      in = !in;
  }
  return in;
}

double to_walls(const std::vector<Vec2>& ring, const Vec2& p) {
  double nearest = 1e9;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], side = ring[(k + 1) % ring.size()] - a;
    const double at = std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + at * side - p).norm());
  }
  return nearest;
}

Vec2 free_place(const std::vector<Vec2>& ring, Draw& draw, double clearance) {
  Vec2 low = ring[0], high = ring[0];
  for (const Vec2& p : ring) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int k = 0; k < 1000; ++k) {
    const Vec2 p(draw.within(low.x(), high.x()), draw.within(low.y(), high.y()));
    if (inside(ring, p) && to_walls(ring, p) > clearance) return p;
  }
  return (low + high) / 2;
}

// Wardrobes and shelves along the walls, tables in the room.
void furnish(TrialRoom& room, Draw& draw) {
  const auto& ring = room.proxy_plan.footprint;
  const int pieces = 2 + draw.below(5);
  for (int k = 0; k < pieces; ++k) {
    const bool standing = draw.below(2) == 0;
    const Vec3 size(draw.within(0.6, 2.2), draw.within(0.35, 0.8),
                    standing ? draw.within(1, 2.2) : draw.within(0.4, 0.8));
    const std::size_t side = static_cast<std::size_t>(draw.below(static_cast<int>(ring.size())));
    const Vec2 a = ring[side], b = ring[(side + 1) % ring.size()], along = (b - a).normalized();
    Vec2 centre = a + draw.within(0.2, 0.8) * (b - a) + Vec2(-along.y(), along.x()) * (size.y() / 2 + 0.03);
    double turn = std::atan2(along.y(), along.x());
    if (!standing) {
      centre = free_place(ring, draw, 0.9);
      turn += draw.within(-0.3, 0.3);
    }
    const Vec3 middle(centre.x(), centre.y(), size.z() / 2 + 0.001);
    add_box(room.truth, middle - size / 2, middle + size / 2, turn, false);
  }
}

// Whole planes move, as a modeller errs: each vertex goes along with its three planes.
void displace(PolygonModel& model, Draw& draw, double sigma_m) {
  std::vector<Mat3> normals(model.vertices.size(), Mat3::Zero());
  std::vector<Vec3> right(model.vertices.size(), Vec3::Zero());
  for (const Face& face : model.faces) {
    const double shift = std::clamp(draw.normal(), -2.0, 2.0) * sigma_m;
    const Vec3 n = face_plane(model, face).normal;
    const auto move = [&](const std::vector<std::uint32_t>& vertices) {
      for (const std::uint32_t v : vertices) {
        normals[v] += n * n.transpose();
        right[v] += shift * n;
      }
    };
    move(face.outer);
    for (const auto& hole : face.holes) move(hole);
  }
  for (std::size_t v = 0; v < model.vertices.size(); ++v)
    model.vertices[v] += (normals[v] + 1e-9 * Mat3::Identity()).ldlt().solve(right[v]);
}

Plane towards(const Plane& plane, const Vec3& eye) {
  return plane.distance(eye) < 0 ? Plane{-plane.normal, -plane.offset_m} : plane;
}

}  // namespace

Pose moved_at_random(const Pose& pose, double distance_m, double deg, std::uint32_t seed) {
  Draw draw(seed, 11);
  const auto axis = [&] { return Vec3(draw.normal(), draw.normal(), draw.normal()).normalized(); };
  Pose moved = pose;
  moved.translation += distance_m * axis();
  moved.rotation = Eigen::AngleAxisd(deg * std::numbers::pi / 180, axis()) * pose.rotation;
  return moved;
}

double Draw::within(double low, double high) {
  return low + (high - low) * random_bits(seed_, purpose_, next_++) / 4294967296.0;
}
int Draw::below(int count) {
  return std::min(static_cast<int>(within(0, count)), count - 1);
}
double Draw::normal() {
  const double u = within(1e-12, 1), v = within(0, 2 * kPi);
  return std::sqrt(-2 * std::log(u)) * std::cos(v);
}

PolygonModel room_model(const RoomPlan& plan) {
  PolygonModel model;
  std::vector<Vec3> floor, ceiling;
  for (const Vec2& p : plan.footprint) floor.emplace_back(p.x(), p.y(), 0);
  for (auto p = plan.footprint.rbegin(); p != plan.footprint.rend(); ++p)
    ceiling.emplace_back(p->x(), p->y(), plan.height_m);
  model.faces.push_back({"floor", ring_of(model, floor), {}});
  model.faces.push_back({"ceiling", ring_of(model, ceiling), {}});
  for (std::size_t side = 0; side < plan.footprint.size(); ++side) add_wall(model, plan, side);
  return model;
}

TrialRoom make_trial_room(const std::string& kind, std::uint32_t seed, double proxy_error_m) {
  Draw draw(seed, 1);
  TrialRoom room;
  RoomPlan plan{footprint_of(kind, draw), draw.within(2.4, 4), {}};
  Slots slots(plan, draw);
  const int niches = kind == "niche" || kind == "alcoves" ? 1 : kind == "hall" ? 3 : 0;
  for (int k = 0; k < niches; ++k) plan.recesses.push_back(slots.recess(0.3, 1.2));
  room.proxy_plan = plan;
  room.proxy = room_model(plan);
  const int unmodelled = draw.below(4);
  const bool deep = kind == "alcoves";
  for (int k = 0; k < unmodelled; ++k)
    plan.recesses.push_back(slots.recess(deep ? 0.3 : 0.08, deep ? 1.2 : 0.35));
  room.truth = room_model(plan);
  furnish(room, draw);
  if (proxy_error_m > 0) displace(room.proxy, draw, proxy_error_m);
  return room;
}

TrialScan scan_trial_room(device::Queue& queue, const TrialRoom& room, std::uint32_t seed, double crop,
                          int rows, int cols) {
  Draw draw(seed, 2);
  TrialScan scan;
  const Vec2 stand = free_place(room.proxy_plan.footprint, draw, 0.8);
  const double tilt = kPi / 180;
  scan.world_from_scan.translation = {stand.x(), stand.y(), draw.within(1.2, 1.8)};
  scan.world_from_scan.rotation = Eigen::AngleAxisd(tilt * draw.normal(), Vec3::UnitX()) *
                                  Eigen::AngleAxisd(tilt * draw.normal(), Vec3::UnitY()) *
                                  Eigen::AngleAxisd(draw.within(-kPi, kPi), Vec3::UnitZ());
  auto& image = scan.image;
  image = make_range_image(rows, cols);
  image.wraps = true;
  for (int row = 0; row < rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = kPi / 2 - kPi * 0.83 * (row + 0.5) / rows;
  for (int col = 0; col < cols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = -kPi + 2 * kPi * (col + 0.5) / cols;

  std::vector<float> directions(3 * image.count());
  std::vector<Vec3> rays(image.count());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      const std::size_t i = image.index(row, col);
      rays[i] = Vec3(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const Vec3f d = scan.world_from_scan.rotate(rays[i]).cast<float>();
      for (int k = 0; k < 3; ++k) directions[3 * i + static_cast<std::size_t>(k)] = d(k);
    }
  std::vector<TriangleRecord> triangles;
  for (const Triangle& t : triangulate(room.truth)) {
    TriangleRecord record{};
    for (int k = 0; k < 3; ++k) {
      record.a[k] = static_cast<float>(room.truth.vertices[t.vertices[0]](k));
      record.b[k] = static_cast<float>(room.truth.vertices[t.vertices[1]](k));
      record.c[k] = static_cast<float>(room.truth.vertices[t.vertices[2]](k));
    }
    record.id = 1 + t.face;
    triangles.push_back(record);
  }
  const auto bvh = stages::upload_bvh(queue, stages::build_bvh(triangles, {}), {});
  RayCastParams params{};
  for (int k = 0; k < 3; ++k)
    params.camera.centre[k] = static_cast<float>(scan.world_from_scan.translation(k));
  params.cols = static_cast<std::uint32_t>(image.count());
  params.rows = 1;
  params.root = bvh.root;
  auto distance = queue.array<float>(image.count());
  auto id = queue.array<std::uint32_t>(image.count());
  queue.launch("ray_cast", queue.kernel("ray_cast", {{"VW", queue.vector_width()}}),
               stages::packet_grid(queue.vector_width(), image.count(), 1), params, bvh.nodes, bvh.triangles,
               bvh.spheres, bvh.surfaces, queue.array(directions), distance, id, queue.array<float>(0));
  const auto ids = queue.read(id);
  const auto ranges = queue.read(distance);

  std::vector<std::size_t> seen(room.truth.faces.size());
  for (const auto face : ids)
    if (face) ++seen[face - 1];
  std::vector<std::uint32_t> label(seen.size(), 0);
  auto& clusters = scan.segmentation.superclusters;
  const Pose scan_from_world = scan.world_from_scan.inverse();
  for (std::size_t f = 0; f < seen.size(); ++f) {
    if (seen[f] < 40) continue;
    Supercluster one;
    one.id = label[f] = static_cast<std::uint32_t>(clusters.size() + 1);
    const Plane plane =
        towards(face_plane(room.truth, room.truth.faces[f]), scan.world_from_scan.translation);
    one.plane.normal = scan_from_world.rotate(plane.normal);
    one.plane.offset_m = plane.offset_m - plane.normal.dot(scan.world_from_scan.translation);
    clusters.push_back(one);
  }
  scan.segmentation.sample_label.assign(image.count(), 0);
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (!ids[i]) continue;
    const double range = static_cast<double>(ranges[i]) + 0.002 * draw.normal();
    const Vec3f p = (range * rays[i]).cast<float>();
    image.range_m[i] = static_cast<float>(range);
    image.x[i] = p.x(), image.y[i] = p.y(), image.z[i] = p.z();
    image.mask[i] = kMeasured;
    image.source[i] = static_cast<std::uint32_t>(i);
    const std::uint32_t l = scan.segmentation.sample_label[i] = label[ids[i] - 1];
    if (!l) continue;
    ++clusters[l - 1].samples;
    clusters[l - 1].centroid_m += p.cast<double>();
  }
  for (auto& one : clusters) {
    one.centroid_m /= static_cast<double>(one.samples);
    one.area_m2 = static_cast<double>(one.samples);
  }
  if (crop < 1) crop_scan(image, scan.segmentation, draw.within(-kPi, kPi), crop);
  return scan;
}

void crop_scan(RangeImage& image, PlaneSegmentation& segmentation, double from_rad, double crop) {
  for (int col = 0; col < image.cols; ++col) {
    const double turn =
        std::fmod(image.azimuth_rad[static_cast<std::size_t>(col)] - from_rad + 8 * kPi, 2 * kPi);
    if (turn <= crop * 2 * kPi) continue;
    for (int row = 0; row < image.rows; ++row) {
      const std::size_t i = image.index(row, col);
      image.mask[i] = kEmpty;
      segmentation.sample_label[i] = 0;
      image.range_m[i] = image.x[i] = image.y[i] = image.z[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

std::unique_ptr<stages::IcpScan> icp_scan_of(device::Queue& queue, const TrialScan& scan, int samples) {
  return std::make_unique<stages::IcpScan>(
      queue, stages::choose_scan_samples(scan.image, scan.segmentation, {}, samples, 1), scan.image,
      scan.segmentation, std::vector<std::uint8_t>());
}

}  // namespace hybrid::testing
