#include "stages/registration/scan_model.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "stages/contours/contour_polygons.hpp"

namespace hybrid::stages {
namespace {

constexpr double kStraighten[] = {4, 2, 0.75, 0};  // sample spacings: the first that leaves a simple polygon
constexpr double kLeastArea_m2 = 0.02;

void append(const PolygonModel& from, std::uint32_t id, PolygonModel& to) {
  const auto shift = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
  for (Face face : from.faces) {
    face.name = fmt::format("supercluster {}", id);
    for (std::uint32_t& vertex : face.outer) vertex += shift;
    for (auto& hole : face.holes)
      for (std::uint32_t& vertex : hole) vertex += shift;
    to.faces.push_back(std::move(face));
  }
}

}  // namespace

PolygonModel model_of_scan(const RangeImage& image, const PlaneSegmentation& segmentation) {
  PolygonModel model;
  for (const Supercluster& one : segmentation.superclusters) {
    PolygonModel polygons;
    for (const double straighten : kStraighten) {
      polygons = polygons_of(flat_rings(image, one, straighten));
      if (!polygons.faces.empty() && can_be_triangulated(polygons)) break;
      polygons = {};
    }
    std::erase_if(polygons.faces,
                  [&](const Face& face) { return face_area_m2(polygons, face) < kLeastArea_m2; });
    append(polygons, one.id, model);
  }
  return model;
}

}  // namespace hybrid::stages
