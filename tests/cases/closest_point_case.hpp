#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "device/queue.hpp"
#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "lib/random.h"
#include "stages/registration/proxy_search.hpp"
#include "stages/registration/proxy_tree.hpp"
#include "stages/registration/proxy_triangles.hpp"

namespace hybrid::testing {

// A box from `low` to `high`, turned about Z; its front sides show outwards, or inwards for a room.
inline void add_box(PolygonModel& model, const Vec3& low, const Vec3& high, double turn_rad, bool room) {
  const auto base = static_cast<std::uint32_t>(model.vertices.size());
  const Vec3 centre = (low + high) / 2;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
    model.vertices.push_back(centre + Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) * (corner - centre));
  }
  const std::uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& side : sides) {
    Face face;
    face.name = "face-" + std::to_string(model.faces.size());
    for (int k = 0; k < 4; ++k) face.outer.push_back(base + side[room ? 3 - k : k]);
    model.faces.push_back(face);
  }
}

// 100 m off the origin: a room of 20 x 12 x 6 m with 14 turned blocks in it, 180 triangles. Queries lie
// within 10 cm of its faces, with normals within 20 degrees of theirs, in the order of the faces, as scans
// come.
struct ClosestPointCase {
  static constexpr const char* kName = "closest_point";
  struct Input {
    PolygonModel model;
    Pose local_from_scan;
    Vec3 origin;
    float gate_m = INFINITY;
    double normal_deg = 45;
    std::vector<float> x, y, z, nx, ny, nz;
    int lanes = 0;  // 0 = the device's choice
  };
  struct Output {
    std::vector<float> distance, height, near_x, near_y, near_z;
    std::vector<std::uint32_t> triangle;
    std::vector<char> doubtful;  // reference only: a normal is within rounding of the largest angle
  };

  static Input make(std::size_t size, std::uint32_t seed) {
    Input in;
    in.origin = Vec3(100, -50, 10);
    add_box(in.model, in.origin + Vec3(-10, -6, -3), in.origin + Vec3(10, 6, 3), 0, true);
    for (std::uint32_t i = 0; i < 14; ++i) {
      auto u = [&](std::uint32_t k) { return random_bits(seed, i, 50 + k) / 4294967296.0; };
      const Vec3 low = in.origin + Vec3(-9 + 16 * u(0), -5 + 9 * u(1), -3);
      add_box(in.model, low, low + Vec3(0.3 + u(2), 0.3 + u(3), 0.5 + 3 * u(4)), 3 * u(5), false);
    }
    in.local_from_scan.rotation = Eigen::AngleAxisd(0.8, Vec3(0.2, -0.1, 1).normalized());
    in.local_from_scan.translation = Vec3(1.5, -2, 0.25);
    const Pose scan_from_local = in.local_from_scan.inverse();
    for (std::size_t i = 0; i < size; ++i) {
      auto u = [&](std::uint32_t k) {
        return random_bits(seed, static_cast<std::uint32_t>(i), k) / 4294967296.0;
      };
      const Face& face = in.model.faces[i * in.model.faces.size() / size];
      const Vec3 a = in.model.vertices[face.outer[0]], b = in.model.vertices[face.outer[1]],
                 d = in.model.vertices[face.outer[3]];
      const Vec3 on_face = a + u(0) * (b - a) + u(1) * (d - a) - in.origin;
      const Vec3 noise = 0.1 * Vec3(2 * u(2) - 1, 2 * u(3) - 1, 2 * u(4) - 1);
      const Vec3 p = scan_from_local * (on_face + noise);
      const Vec3 n = scan_from_local.rotate(
          (face_plane(in.model, face).normal + 0.3 * Vec3(u(5) - 0.5, u(6) - 0.5, u(7) - 0.5)).normalized());
      const bool missing = random_below(seed, static_cast<std::uint32_t>(i), 8, 50) == 0;
      const bool unoriented = random_below(seed, static_cast<std::uint32_t>(i), 9, 50) == 0;
      in.x.push_back(missing ? NAN : static_cast<float>(p.x()));
      in.y.push_back(missing ? NAN : static_cast<float>(p.y()));
      in.z.push_back(missing ? NAN : static_cast<float>(p.z()));
      in.nx.push_back(unoriented ? NAN : static_cast<float>(n.x()));
      in.ny.push_back(unoriented ? NAN : static_cast<float>(n.y()));
      in.nz.push_back(unoriented ? NAN : static_cast<float>(n.z()));
    }
    return in;
  }

  static Output run(device::Queue& queue, const Input& in) {
    return run(queue, in, stages::proxy_triangles(in.model, in.origin), nullptr);
  }
  // These records by closest_point, or by closest_point_tree where a tree of them is given.
  static Output run(device::Queue& queue, const Input& in, const std::vector<ProxyTriangle>& records,
                    const stages::ProxyTree* tree) {
    const int lanes = in.lanes ? in.lanes : queue.vector_width();
    const std::size_t count = in.x.size();
    ClosestPointParams params{};
    const Mat3 linear = in.local_from_scan.scale * in.local_from_scan.rotation.toRotationMatrix();
    for (int k = 0; k < 9; ++k) params.linear[k] = static_cast<float>(linear(k / 3, k % 3));
    for (int k = 0; k < 3; ++k) params.translation[k] = static_cast<float>(in.local_from_scan.translation(k));
    params.gate2 = in.gate_m * in.gate_m;
    params.min_facing = static_cast<float>(in.local_from_scan.scale * min_cosine(in.normal_deg));
    params.queries = static_cast<std::uint32_t>(count);
    params.triangles = static_cast<std::uint32_t>(records.size());
    auto x = queue.array(in.x), y = queue.array(in.y), z = queue.array(in.z);
    auto nx = queue.array(in.nx), ny = queue.array(in.ny), nz = queue.array(in.nz);
    auto triangles = queue.array(records);
    auto distance = queue.array<float>(count), height = queue.array<float>(count);
    auto near_x = queue.array<float>(count), near_y = queue.array<float>(count),
         near_z = queue.array<float>(count);
    auto triangle = queue.array<std::uint32_t>(count);
    const int run = tree != nullptr ? stages::packets_in_a_run(lanes) : 1;
    const auto width = static_cast<std::size_t>(lanes * run);
    const auto items = (count + width - 1) / width;
    if (tree != nullptr) {
      params.root = tree->root;
      queue.launch("closest_point_tree", queue.kernel("closest_point_tree", {{"VW", lanes}, {"RUN", run}}),
                   device::grid(items), params, x, y, z, nx, ny, nz, triangles, queue.array(tree->nodes),
                   distance, height, triangle, near_x, near_y, near_z);
    } else {
      queue.launch(kName, queue.kernel(kName, {{"VW", lanes}}), device::grid(items), params, x, y, z, nx, ny,
                   nz, triangles, distance, height, triangle, near_x, near_y, near_z);
    }
    return {queue.read(distance),
            queue.read(height),
            queue.read(near_x),
            queue.read(near_y),
            queue.read(near_z),
            queue.read(triangle),
            {}};
  }
  static Output reference(const Input& input);  // reference/closest_point.cpp

  static double min_cosine(double normal_deg) {
    return normal_deg < 180 ? std::cos(normal_deg * std::numbers::pi / 180) : -2;
  }
  // Distance in double from point (local frame) to one triangle.
  static double distance_to(const Input& input, const Triangle& triangle, const Vec3& point_in_local);

  // Coordinates up to 15 m in float (1e-6), rotated and compared after a few operations.
  static constexpr double kTolerance = 1e-5;
  static double items(const Input& input) { return static_cast<double>(input.x.size()); }
  static double bytes(const Input& input) { return 48 * items(input); }
  // Passing over every triangle once: what the rest costs depends on the data.
  static double flops(const Input& input) { return items(input) * 12 * 180; }
};

}  // namespace hybrid::testing
