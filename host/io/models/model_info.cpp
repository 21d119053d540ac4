#include "io/models/model_info.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace hybrid::io {
namespace {

FaceInfo describe_face(const PolygonModel& model, const Face& face) {
  FaceInfo result;
  result.name = face.name;
  result.vertices = face.outer.size();
  result.holes = face.holes.size();
  try {
    result.area_m2 = face_area_m2(model, face);
    const Plane plane = face_plane(model, face);
    for (std::uint32_t vertex : face.outer)
      result.off_plane_m = std::max(result.off_plane_m, std::abs(plane.distance(model.vertices[vertex])));
  } catch (const Error& error) {
    result.problem = error.what();
  }
  return result;
}

}  // namespace

ModelInfo describe_model(const PolygonModel& model) {
  ModelInfo result;
  result.vertices = model.vertices.size();
  if (!model.vertices.empty()) result.minimum = result.maximum = model.vertices.front();
  for (const Vec3& vertex : model.vertices) {
    result.minimum = result.minimum.cwiseMin(vertex);
    result.maximum = result.maximum.cwiseMax(vertex);
  }
  for (const Face& face : model.faces) {
    result.faces.push_back(describe_face(model, face));
    result.area_m2 += result.faces.back().area_m2;
  }
  return result;
}

CentreBox box_of_centres(const std::vector<Photograph>& photographs) {
  CentreBox box;
  if (!photographs.empty()) box.minimum = box.maximum = photographs.front().centre();
  for (const Photograph& photograph : photographs) {
    box.minimum = box.minimum.cwiseMin(photograph.centre());
    box.maximum = box.maximum.cwiseMax(photograph.centre());
  }
  return box;
}

}  // namespace hybrid::io
