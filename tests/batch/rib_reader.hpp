#pragma once
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid::testing {

// A scene rebuilt from RIB text by a strict reader that knows the requests an export uses, their arguments
// and their nesting, and nothing of the writer. Throws std::runtime_error with file and line: renderers often
// go on after what is wrong.
struct RibFile {
  using Matrix = Eigen::Matrix4d;  // for points as columns: the transpose of what RIB holds

  struct Frame {
    int width = 0, height = 0;
    double left = 0, right = 0, bottom = 0, top = 0;  // screen window, at z = 1 (fov 90)
    Matrix camera_from_world = Matrix::Identity();
  };
  struct Polygon {
    std::string name;
    std::vector<std::vector<Vec3>> rings;  // world
  };
  struct Ball {
    Vec3 centre;
    double radius;
  };
  struct Light {
    std::string shader;
    Matrix world_from_light = Matrix::Identity();
    std::map<std::string, double> numbers;
    std::map<std::string, std::string> strings;
  };

  std::vector<Frame> frames;
  std::vector<Polygon> polygons;  // of the first frame's world
  std::vector<Ball> balls;
  std::vector<Light> lights;
  std::set<std::string> files;  // everything it names and that must exist, relative
  std::string surface;
  std::map<std::string, double> surface_numbers;

  // Distance along the camera's axis of what each pixel of a frame sees, row by row; infinite: nothing.
  std::vector<double> depth(const Frame& frame) const;
};

// Reads `file` and the archives it names; checks that every file is there, that a texture is made before it
// is used, and that shaders' sources declare the parameters that they are given.
RibFile read_rib(const std::filesystem::path& file);

}  // namespace hybrid::testing
