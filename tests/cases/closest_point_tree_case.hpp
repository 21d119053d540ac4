#pragma once
#include "cases/closest_point_case.hpp"
#include "stages/registration/proxy_tree.hpp"

namespace hybrid::testing {

// The room and its blocks as a mesh: every rectangle cut into `side` x `side` cells of two triangles, whose
// inner corners are off by up to 5 mm, as of a mesh that was made from a scan.
struct ClosestPointTreeCase : ClosestPointCase {
  static constexpr const char* kName = "closest_point_tree";

  static void cut(PolygonModel& model, int side, std::uint32_t seed, double rough_m = 0.01) {
    PolygonModel mesh;
    for (const Face& face : model.faces) {
      const Vec3 a = model.vertices[face.outer[0]], right = model.vertices[face.outer[1]] - a,
                 up = model.vertices[face.outer[3]] - a, normal = right.cross(up).normalized();
      const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
      const auto at = [&](int row, int col) {
        return base + static_cast<std::uint32_t>(row * (side + 1) + col);
      };
      for (int row = 0; row <= side; ++row)
        for (int col = 0; col <= side; ++col) {
          const bool inner = row % side != 0 && col % side != 0;
          const double off = inner ? rough_m * (random_bits(seed, at(row, col), 77) / 4294967296.0 - 0.5) : 0;
          mesh.vertices.push_back(a + right * (static_cast<double>(col) / side) +
                                  up * (static_cast<double>(row) / side) + off * normal);
        }
      for (int row = 0; row < side; ++row)
        for (int col = 0; col < side; ++col)
          for (int half = 0; half < 2; ++half) {
            Face triangle;
            triangle.name = "triangle-" + std::to_string(mesh.faces.size());
            triangle.outer = {at(row, col), half ? at(row + 1, col + 1) : at(row, col + 1),
                              half ? at(row + 1, col) : at(row + 1, col + 1)};
            mesh.faces.push_back(triangle);
          }
    }
    model = std::move(mesh);
  }

  // Queries row by row over each face, as scans come: 1 cm of noise, and 5 cm off as before registration.
  // Normals, missing and unoriented ones as in ClosestPointCase. Of its rectangles the first `most_faces`.
  static Input make(std::size_t size, std::uint32_t seed, int side = 4, std::size_t most_faces = 1000) {
    Input in = ClosestPointCase::make(size, seed);
    in.model.faces.resize(std::min(in.model.faces.size(), most_faces));
    const Pose scan_from_local = in.local_from_scan.inverse();
    const std::size_t faces = in.model.faces.size(), per_face = size / faces + 1;
    const auto cols = static_cast<std::size_t>(std::sqrt(static_cast<double>(per_face))) + 1;
    for (std::size_t i = 0; i < size; ++i) {
      if (std::isnan(in.x[i])) continue;
      const Face& face = in.model.faces[i * faces / size];
      const std::size_t k = i - (i * faces / size * size + faces - 1) / faces;  // on this face
      const auto noise = [&](std::uint32_t n) {
        return 0.02 * (random_bits(seed, static_cast<std::uint32_t>(i), 90 + n) / 4294967296.0 - 0.5);
      };
      const Vec3 a = in.model.vertices[face.outer[0]], b = in.model.vertices[face.outer[1]],
                 d = in.model.vertices[face.outer[3]];
      const double along = (static_cast<double>(k % cols) + 0.5) / static_cast<double>(cols);
      const double up = (static_cast<double>(k / cols) + 0.5) / static_cast<double>(per_face / cols + 1);
      const Vec3 p = scan_from_local * (a + along * (b - a) + up * (d - a) - in.origin +
                                        Vec3(0.03 + noise(0), -0.02 + noise(1), 0.035 + noise(2)));
      in.x[i] = static_cast<float>(p.x());
      in.y[i] = static_cast<float>(p.y());
      in.z[i] = static_cast<float>(p.z());
    }
    cut(in.model, side, seed);
    return in;
  }

  static Output run(device::Queue& queue, const Input& in) {
    return run(queue, in, stages::make_proxy_tree(stages::proxy_triangles(in.model, in.origin)));
  }
  static Output run(device::Queue& queue, const Input& in, const stages::ProxyTree& tree) {
    return ClosestPointCase::run(queue, in, tree.triangles, &tree);
  }
  // All triangles in the order of the leaves.
  static Output brute_force(device::Queue& queue, const Input& in, const stages::ProxyTree& tree) {
    return ClosestPointCase::run(queue, in, tree.triangles, nullptr);
  }
  static Output reference(const Input& input);  // reference/closest_point_tree.cpp
  // Two boxes on each of about 15 levels, per query.
  static double flops(const Input& input) { return items(input) * 15 * 2 * 20; }
};

}  // namespace hybrid::testing
