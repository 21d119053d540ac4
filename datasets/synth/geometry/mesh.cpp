#include "geometry/mesh.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

namespace synth {
namespace {

using Place = std::tuple<float, float, float>;

Place place_of(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

Vec3 Surface::smooth_normal(const Vec3& point) const {
  switch (shape) {
    case Shape::plane:
    case Shape::free:
      return normal;
    case Shape::cylinder:
      return Vec3(point.x() - origin.x(), point.y() - origin.y(), 0).normalized();
    case Shape::ellipsoid:
      return (point - origin).cwiseQuotient(radii.cwiseProduct(radii)).normalized();
  }
  return normal;
}

void weld(Mesh& mesh) {
  std::map<Place, std::uint32_t> places;
  Mesh welded;
  std::vector<std::uint32_t> target;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto [place, is_new] =
        places.try_emplace(place_of(mesh.vertices[i]), static_cast<std::uint32_t>(welded.vertices.size()));
    target.push_back(place->second);
    if (!is_new) continue;
    welded.vertices.push_back(mesh.vertices[i]);
    welded.normals.push_back(mesh.normals[i]);
    welded.coordinates.push_back(mesh.coordinates[i]);
  }
  mesh.vertices = std::move(welded.vertices);
  mesh.normals = std::move(welded.normals);
  mesh.coordinates = std::move(welded.coordinates);
  for (auto& triangle : mesh.triangles)
    for (auto& corner : triangle) corner = target[corner];
}

void check_closed(const Mesh& mesh, std::size_t first_triangle) {
  std::set<std::pair<Place, Place>> edges;
  for (std::size_t i = first_triangle; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place from = place_of(mesh.vertices[mesh.triangles[i][k]]),
                  to = place_of(mesh.vertices[mesh.triangles[i][(k + 1) % 3]]);
      if (!edges.emplace(from, to).second)
        throw std::logic_error(fmt::format("synthetic mesh: two faces of {} run along one edge the same way",
                                           mesh.surfaces[mesh.surface_of_triangle[i]].name));
    }
  }
  for (const auto& [from, to] : edges) {
    if (edges.contains({to, from})) continue;
    const auto& [ax, ay, az] = from;
    const auto& [bx, by, bz] = to;
    throw std::logic_error(fmt::format("synthetic mesh: {} is open along ({}, {}, {}) - ({}, {}, {})",
                                       mesh.surfaces[mesh.surface_of_triangle[first_triangle]].name, ax, ay,
                                       az, bx, by, bz));
  }
}

}  // namespace synth
