#include "batch/export/export_meshes.hpp"

#include <algorithm>
#include <map>

namespace hybrid::batch {
namespace {

// The face's own vertices, each once, its rings and its triangles.
io::TexturedMesh face_mesh(const PolygonModel& model, const std::vector<Triangle>& triangles,
                           std::uint32_t index) {
  const Face& face = model.faces[index];
  io::TexturedMesh mesh;
  mesh.name = face.name;
  mesh.normal = face_plane(model, face).normal;
  std::map<std::uint32_t, std::uint32_t> own;
  const auto own_ring = [&](const std::vector<std::uint32_t>& ring) {
    std::vector<std::uint32_t> numbers;
    for (const std::uint32_t vertex : ring) {
      const auto [at, is_new] = own.emplace(vertex, static_cast<std::uint32_t>(mesh.positions.size()));
      if (is_new) mesh.positions.push_back(model.vertices[vertex]);
      numbers.push_back(at->second);
    }
    mesh.rings.push_back(std::move(numbers));
  };
  own_ring(face.outer);
  for (const auto& hole : face.holes) own_ring(hole);
  const auto first = std::lower_bound(triangles.begin(), triangles.end(), index,
                                      [](const Triangle& t, std::uint32_t f) { return t.face < f; });
  for (auto t = first; t != triangles.end() && t->face == index; ++t)
    for (const std::uint32_t vertex : t->vertices) mesh.triangles.push_back(own.at(vertex));
  return mesh;
}

void turn_round(io::TexturedMesh& mesh) {
  mesh.name += "-back";
  mesh.normal = -mesh.normal;
  for (auto& ring : mesh.rings) std::reverse(ring.begin(), ring.end());
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
    std::swap(mesh.triangles[t + 1], mesh.triangles[t + 2]);
}

}  // namespace

std::vector<io::TexturedMesh> textured_meshes(const stages::RenderScene& scene,
                                              const std::vector<stages::AtlasChart>& charts) {
  const auto proxy = triangulate(scene.proxy), contours = triangulate(scene.contours);
  std::vector<io::TexturedMesh> meshes;
  for (const stages::AtlasChart& chart : charts) {
    auto mesh = chart.contour ? face_mesh(scene.contours, contours, chart.face)
                              : face_mesh(scene.proxy, proxy, chart.face);
    mesh.page = chart.page;
    for (const Vec3& position : mesh.positions)
      mesh.texels.push_back(Vec2(chart.x, chart.y) + chart.position(position));
    if (chart.back) turn_round(mesh);
    meshes.push_back(std::move(mesh));
  }
  return meshes;
}

std::vector<io::TexturedMesh> plain_meshes(const stages::RenderScene& scene) {
  std::vector<io::TexturedMesh> meshes;
  for (const PolygonModel* model : {&scene.proxy, &scene.contours}) {
    const auto triangles = triangulate(*model);
    for (std::uint32_t face = 0; face < model->faces.size(); ++face)
      meshes.push_back(face_mesh(*model, triangles, face));
  }
  return meshes;
}

}  // namespace hybrid::batch
