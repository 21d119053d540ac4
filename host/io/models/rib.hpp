#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid::io {

// A photograph as a slide projector: the files must lie in the RIB's folder.
struct RibProjector {
  Photograph photograph;
  std::string slide;  // picture, sRGB, relative to the RIB
  std::string depth;  // what it shows, in metres: along the axis, of panoramas along the ray; 1e9 nothing
};

struct RibSphere {
  Vec3 centre = Vec3::Zero();
  double radius_m = 0;
};

struct RibView {
  std::string name;
  Photograph camera;  // without distortion
};

struct RibScene {
  PolygonModel proxy, contours;
  std::vector<RibSphere> samples;
  std::vector<RibProjector> projectors;
  std::vector<RibView> views;
  bool points = true;         // samples as RiPoints of their diameter, else as spheres
  double tolerance_m = 0.02;  // by which a surface may lie behind what a projector's depth says
  double feather_px = 32;
  double grazing_deg = 2;  // a photograph that meets a surface at no more than this does not see it
};

// The paper's export (2.4), RIB-Structure 1.1: `folder`/scene.rib with a frame per view, which reads
// world.rib: every face as a general polygon with its holes, the samples, one light per photograph
// (hybrid_projector.sl) and the surface shader that blends them by view (hybrid_blend.sl); both shaders'
// sources are written beside. MakeTexture statements turn the pictures into textures first. Coordinates are
// relative to a point that the files name where they are large; metres, Z up. Throws as write_text() does,
// and ErrorKind::failed for a view with distortion.
void write_rib(const std::filesystem::path& folder, const RibScene& scene);

}  // namespace hybrid::io
