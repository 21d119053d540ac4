#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

// What `hybrid info` tells about a model or a camera file.
struct FaceInfo {
  std::string name;
  std::size_t vertices = 0, holes = 0;  // vertices of the outer ring
  double area_m2 = 0;                   // holes taken off
  double off_plane_m = 0;  // largest distance of a vertex of the outer ring from the face's plane
  std::string problem;     // why no stage can use this face (no area), or ""
};

struct ModelInfo {
  std::size_t vertices = 0;
  std::vector<FaceInfo> faces;
  double area_m2 = 0;
  Vec3 minimum = Vec3::Zero(), maximum = Vec3::Zero();  // of all vertices, metres
};

// A face that the stages would refuse is described with its problem, so that `hybrid info` can show all of
// them.
ModelInfo describe_model(const PolygonModel& model);

// Of the photographs' centres, in the frame of the camera file.
struct CentreBox {
  Vec3 minimum = Vec3::Zero(), maximum = Vec3::Zero();
};
CentreBox box_of_centres(const std::vector<Photograph>& photographs);

}  // namespace hybrid::io
