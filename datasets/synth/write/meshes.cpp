#include "write/meshes.hpp"

#include <fmt/format.h>

#include <bit>

#include "write/files.hpp"

namespace synth {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written in the machine's byte order");

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

void write_detail_ply(const std::filesystem::path& path, const Mesh& apart) {
  Mesh mesh = apart;
  weld(mesh);
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment world frame, metres; plane 0 = curved\nelement vertex "
      "{}\n"
      "property float x\nproperty float y\nproperty float z\nelement face {}\n"
      "property list uchar int vertex_indices\nproperty int surface\nproperty int plane\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    for (float coordinate : vertex) append(bytes, coordinate);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    append(bytes, std::uint8_t{3});
    for (std::uint32_t corner : mesh.triangles[i]) append(bytes, corner);
    append(bytes, mesh.surface_of_triangle[i]);
    append(bytes, static_cast<std::int32_t>(mesh.surfaces[mesh.surface_of_triangle[i]].plane_id));
  }
  write_bytes(path, bytes);
}

void write_proxy_obj(const std::filesystem::path& path, const Proxy& proxy) {
  std::string text = "# As a person would block it out: metres, Z up, faces towards the free side\n";
  for (const Vec3& v : proxy.moved) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const ProxyFace& face : proxy.faces) {
    text += fmt::format("g {}\nf", face.name);
    for (std::uint32_t v : face.ring) text += fmt::format(" {}", v + 1);
    text += "\n";
  }
  write_bytes(path, text);
}

}  // namespace synth
