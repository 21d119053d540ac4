#pragma once
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "geometry/vectors.hpp"
#include "io/files.hpp"

namespace hybrid::testing {

// What a COLMAP text model's images saw of its points, read here without the reader under test.
struct Observation {
  Vec3 point;  // world
  Vec2 pixel;
};

// By the photograph's name.
inline std::map<std::string, std::vector<Observation>> tracks_of(const std::filesystem::path& folder) {
  std::map<int, std::string> names;
  std::map<int, std::vector<Vec2>> pixels;
  std::ifstream images(folder / "images.txt"), points(folder / "points3D.txt");
  for (std::string first, second; std::getline(images, first);) {
    if (first.starts_with('#')) continue;
    std::getline(images, second);
    std::istringstream words(first), seen(second);
    int id = 0, camera = 0;
    double skip = 0;
    words >> id;
    for (int i = 0; i < 7; ++i) words >> skip;
    words >> camera >> names[id];
    for (double x = 0, y = 0, point = 0; seen >> x >> y >> point;) pixels[id].push_back({x, y});
  }
  std::map<std::string, std::vector<Observation>> result;
  for (std::string line; std::getline(points, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    double id = 0, colour = 0, x = 0, y = 0, z = 0, error = 0;
    words >> id >> x >> y >> z >> colour >> colour >> colour >> error;
    for (std::size_t index = 0, image = 0; words >> image >> index;) {
      const int key = static_cast<int>(image);
      result[names.at(key)].push_back({{x, y, z}, pixels.at(key).at(index)});
    }
  }
  return result;
}

}  // namespace hybrid::testing
