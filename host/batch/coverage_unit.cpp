#include "batch/coverage_unit.hpp"

#include <cmath>

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

// To thousandths: millimetres are enough to go there.
double rounded(double value) {
  return std::round(value * 1000) / 1000;
}

Json vector_json(const Vec3& v) {
  return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

}  // namespace

Json coverage_figures(stages::Renderer& renderer, const stages::RenderScene& scene,
                      const stages::CoverageOptions& options) {
  const stages::Coverage coverage = stages::measure_coverage(renderer, scene, options);
  Json faces = Json::array(), next = Json::array();
  for (const auto& face : coverage.faces)
    faces.push_back({{"face", scene.proxy.faces[face.face].name},
                     {"area_m2", face.area_m2},
                     {"unseen_m2", face.unseen_m2}});
  for (const auto& camera : coverage.next)
    next.push_back({{"position", vector_json(camera.position)},
                    {"direction", vector_json(camera.direction)},
                    {"gained_m2", camera.gained_m2}});
  Json json = {{"texel_m", coverage.texel_m},
               {"area_m2", coverage.area_m2},
               {"unseen_m2", coverage.unseen_m2},
               {"faces", faces}};
  if (!coverage.next_camera.empty()) json["next_camera_like"] = coverage.next_camera;
  json["next_cameras"] = next;
  return json;
}

}  // namespace hybrid::batch
