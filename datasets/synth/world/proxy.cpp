#include "world/proxy.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "geometry/random.hpp"

namespace synth {

std::uint32_t Proxy::add_vertex(const Vec3& position, const Vec3& free) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if ((vertices[i].position - position).norm() < 1e-9) return static_cast<std::uint32_t>(i);
  vertices.push_back({position, free});
  moved.push_back(position);
  return static_cast<std::uint32_t>(vertices.size() - 1);
}

void Proxy::add_face(const std::string& name, const std::vector<std::uint32_t>& ring) {
  ProxyFace face{name, ring, Vec3::Zero(), 0, 0};
  for (std::size_t k = 0; k < ring.size(); ++k)
    face.normal += (vertices[ring[k]].position - vertices[ring[0]].position)
                       .cross(vertices[ring[(k + 1) % ring.size()]].position - vertices[ring[0]].position);
  face.normal.normalize();
  face.offset_m = face.normal.dot(vertices[ring[0]].position);
  faces.push_back(face);
}

void move_faces(Proxy& proxy, const Options& options) {
  if (options.proxy_error_m == 0) return;
  for (std::size_t f = 0; f < proxy.faces.size(); ++f) {
    Random random(options.seed, purpose::proxy, f);
    proxy.faces[f].error_m = options.proxy_error_m * std::clamp(random.normal(), -2.0, 2.0);
  }
  for (std::uint32_t v = 0; v < proxy.vertices.size(); ++v) {
    std::vector<const ProxyFace*> around;
    for (const ProxyFace& face : proxy.faces)
      if (std::find(face.ring.begin(), face.ring.end(), v) != face.ring.end()) around.push_back(&face);
    Eigen::MatrixXd normals(around.size(), 3);
    Eigen::VectorXd shifts(around.size());
    for (Eigen::Index k = 0; k < normals.rows(); ++k) {
      normals.row(k) = around[static_cast<std::size_t>(k)]->normal;
      shifts[k] = around[static_cast<std::size_t>(k)]->error_m;
    }
    if (normals.rows() > 0)
      proxy.moved[v] = proxy.vertices[v].position + normals.completeOrthogonalDecomposition().solve(shifts);
  }
}

}  // namespace synth
