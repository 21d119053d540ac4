#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace hybrid::peers {

struct ProxyMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// The proxy's `v` and `f` lines (vertex numbers only, convex faces, fanned). Throws std::runtime_error naming
// file and line.
ProxyMesh read_proxy_obj(const std::filesystem::path& file);

struct SampledProxy {
  std::vector<Eigen::Vector3f> points, normals;
};

// `count` points drawn evenly over the area, with their triangles' normals: the target of peers that know
// only points. The same for the same count.
SampledProxy sample_proxy(const ProxyMesh& mesh, std::size_t count);

}  // namespace hybrid::peers
