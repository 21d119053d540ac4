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

void write_scan_ply(const std::filesystem::path& path, const Scan& scan) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment scan frame, metres; column by column, rising in each\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
      "end_header\n",
      scan.samples.size());
  bytes.reserve(bytes.size() + 16 * scan.samples.size());
  for (const Sample& sample : scan.samples) {
    for (float coordinate : sample.point_in_scan) append(bytes, coordinate);
    append(bytes, sample.intensity);
  }
  write_bytes(path, bytes);
}

void write_detail_ply(const std::filesystem::path& path, const Mesh& mesh) {
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

void write_proxy_obj(const std::filesystem::path& path, const std::vector<Vec3>& vertices) {
  std::string text = "# The room as a person would block it out: metres, Z up, faces towards the inside\n";
  for (const Vec3& v : vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  // Vertex numbers are 1 + the bits x, y, z; counter-clockwise seen from inside.
  text +=
      "g floor\nf 1 2 4 3\n"
      "g ceiling\nf 5 7 8 6\n"
      "g wall-north\nf 3 4 8 7\n"
      "g wall-east\nf 4 2 6 8\n"
      "g wall-south\nf 2 1 5 6\n"
      "g wall-west\nf 1 3 7 5\n";
  write_bytes(path, text);
}

}  // namespace synth
