#include "geometry/mesh.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

namespace synth {

Vec3 Surface::smooth_normal(const Vec3& point) const {
  switch (shape) {
    case Shape::plane:
      return normal;
    case Shape::cylinder:
      return Vec3(point.x() - origin.x(), point.y() - origin.y(), 0).normalized();
    case Shape::ellipsoid:
      return (point - origin).cwiseQuotient(radii.cwiseProduct(radii)).normalized();
  }
  return normal;
}

void weld_and_check_closed(Mesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> places;
  std::vector<Eigen::Vector3f> welded;
  std::vector<std::uint32_t> target;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    const auto [place, is_new] =
        places.try_emplace({v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(welded.size()));
    if (is_new) welded.push_back(v);
    target.push_back(place->second);
  }
  mesh.vertices = std::move(welded);

  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (auto& triangle : mesh.triangles) {
    for (auto& corner : triangle) corner = target[corner];
    for (int k = 0; k < 3; ++k) {
      if (!edges.emplace(triangle[k], triangle[(k + 1) % 3]).second)
        throw std::logic_error("synthetic mesh: two faces run along one edge the same way");
    }
  }
  for (const auto& [from, to] : edges) {
    if (edges.contains({to, from})) continue;
    const Eigen::Vector3f& a = mesh.vertices[from];
    const Eigen::Vector3f& b = mesh.vertices[to];
    throw std::logic_error(fmt::format("synthetic mesh is open along ({}, {}, {}) - ({}, {}, {})", a.x(),
                                       a.y(), a.z(), b.x(), b.y(), b.z()));
  }
}

}  // namespace synth
