#include "batch/export/export_rib.hpp"

#include <algorithm>
#include <cmath>

#include "batch/overview_camera.hpp"
#include "geometry/st_map.hpp"
#include "io/models/rib.hpp"
#include "io/write_picture.hpp"

namespace hybrid::batch {
namespace {

constexpr float kNothing_m = 1e9f;  // in depth pictures: nothing is hit
constexpr float kMasked_m = -1;     // no part of the photograph: everything lies behind it

// A path's frames have a folder in their names, which the renderer's pictures shall not need.
std::string flat_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

std::vector<io::RibView> frames(const std::vector<io::SceneView>& views, const PhotographSet& photographs,
                                const PolygonModel& model, const SayNote& note) {
  std::vector<io::RibView> frames;
  for (const auto& view : views) {
    const auto request = view_request(view, photographs);
    const Camera& camera = request.camera.camera;
    if (camera.panorama() || is_distorted(camera))
      note(fmt::format("scene.rib: view {}: RenderMan's cameras have no distortion: no frame", view.name));
    else
      frames.push_back({flat_name(view.name), request.camera});
  }
  if (frames.empty() && !model.faces.empty())
    frames.push_back({"overview", overview_camera(model, 1280, 720)});
  return frames;
}

Image8 without_alpha(const Image8& image) {
  if (image.channels == 3) return image;
  Image8 rgb(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) std::copy_n(image.at(x, y), 3, rgb.at(x, y));
  return rgb;
}

// What a photograph sees, in its own pixels.
std::vector<float> depth_of(stages::Renderer& renderer, const Photograph& photograph, const Image8& image) {
  stages::ViewRequest request;
  request.camera = photograph;
  request.texture = false;
  auto depth = renderer.render(request).depth_m;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!std::isfinite(depth[i])) depth[i] = kNothing_m;
    if (image.channels == 4 && image.pixels[4 * i + 3] == 0) depth[i] = kMasked_m;
  }
  return depth;
}

}  // namespace

void write_rib_export(stages::Renderer& renderer, const stages::RenderScene& scene,
                      const std::vector<io::SceneView>& views, const PhotographSet& photographs,
                      const StageOptions& options, const std::filesystem::path& folder, const MadeFile& made,
                      const SayNote& note) {
  io::RibScene rib;
  rib.proxy = scene.proxy;
  rib.contours = scene.contours;
  rib.points = options.exporting.rib_samples == "points";
  rib.tolerance_m = options.render.surface_tolerance_m;
  rib.feather_px = options.render.feather_px;
  rib.grazing_deg = options.render.grazing_deg;
  for (const auto& splat : scene.splats)
    if (!splat.on_face && splat.radius_m > 0 && std::isfinite(splat.radius_m))
      rib.samples.push_back({{static_cast<double>(splat.centre_m[0]), static_cast<double>(splat.centre_m[1]),
                              static_cast<double>(splat.centre_m[2])},
                             static_cast<double>(splat.radius_m)});
  if (rib.proxy.faces.empty() && rib.contours.faces.empty() && rib.samples.empty()) {
    note("no faces and no samples: no scene.rib");
    return;
  }
  if (scene.photographs.empty()) note("scene.rib: no photographs: no projectors, everything is red");
  for (std::size_t i = 0; i < scene.photographs.size(); ++i) {
    const auto pixels = stages::photograph_image(scene, i);
    const Image8& image = *pixels;
    io::RibProjector projector{scene.photographs[i], fmt::format("slides/{:04}.tif", i),
                               fmt::format("depth/{:04}.tif", i)};
    io::write_tiff(made(projector.slide), without_alpha(image));
    io::write_tiff(made(projector.depth), image.width, image.height,
                   depth_of(renderer, scene.photographs[i], image));
    rib.projectors.push_back(std::move(projector));
  }
  rib.views = frames(views, photographs, scene.proxy, note);
  for (const char* name : {"hybrid_projector.sl", "hybrid_blend.sl", "world.rib", "scene.rib"}) made(name);
  io::write_rib(folder, rib);
}

}  // namespace hybrid::batch
