#include "shared/proxy_obj.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>

namespace hybrid::peers {

ProxyMesh read_proxy_obj(const std::filesystem::path& file) {
  std::ifstream input(file);
  if (!input) throw std::runtime_error(file.string() + ": cannot be opened");
  ProxyMesh mesh;
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    const auto wrong = [&](const std::string& expected) {
      throw std::runtime_error(file.string() + ": line " + std::to_string(number) + ": expected " + expected);
    };
    if (kind == "v") {
      Eigen::Vector3d v;
      if (!(words >> v.x() >> v.y() >> v.z())) wrong("three coordinates");
      mesh.vertices.push_back(v);
    } else if (kind == "f") {
      std::vector<std::uint32_t> corners;
      for (std::size_t corner; words >> corner;) {
        if (corner < 1 || corner > mesh.vertices.size()) wrong("numbers of vertices above");
        corners.push_back(static_cast<std::uint32_t>(corner - 1));
      }
      if (!words.eof() || corners.size() < 3) wrong("a face of plain vertex numbers");
      for (std::size_t k = 2; k < corners.size(); ++k)
        mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  if (mesh.triangles.empty()) throw std::runtime_error(file.string() + ": expected faces, found none");
  return mesh;
}

SampledProxy sample_proxy(const ProxyMesh& mesh, std::size_t count) {
  std::vector<double> areas;
  for (const auto& [a, b, c] : mesh.triangles)
    areas.push_back((mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm());
  std::mt19937 random(1);
  std::discrete_distribution<std::size_t> pick(areas.begin(), areas.end());
  std::uniform_real_distribution<double> unit;
  SampledProxy sampled;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = mesh.triangles[pick(random)];
    const Eigen::Vector3d u = mesh.vertices[b] - mesh.vertices[a], v = mesh.vertices[c] - mesh.vertices[a];
    const double root = std::sqrt(unit(random)), t = unit(random);
    sampled.points.push_back((mesh.vertices[a] + root * (1 - t) * u + root * t * v).cast<float>());
    sampled.normals.push_back(u.cross(v).normalized().cast<float>());
  }
  return sampled;
}

}  // namespace hybrid::peers
