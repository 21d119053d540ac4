#include "report/figures.hpp"

#include <algorithm>
#include <cmath>

#include "batch/overview_camera.hpp"
#include "core/parallel_blocks.hpp"
#include "io/picture.hpp"

namespace hybrid::report {
namespace {

PolygonModel alone(const PolygonModel& model, Face face) {
  PolygonModel result;
  const auto take = [&](std::vector<std::uint32_t>& ring) {
    for (std::uint32_t& vertex : ring) {
      result.vertices.push_back(model.vertices[vertex]);
      vertex = static_cast<std::uint32_t>(result.vertices.size() - 1);
    }
  };
  take(face.outer);
  for (auto& hole : face.holes) take(hole);
  result.faces.push_back(std::move(face));
  return result;
}

// Leaves out faces and samples that turn their back to the eye, so that one looks into the rooms from
// outside.
void keep_fronts(const Vec3& eye, stages::RenderScene& scene) {
  std::erase_if(scene.proxy.faces,
                [&](const Face& face) { return face_plane(scene.proxy, face).distance(eye) < 0; });
  std::vector<std::uint32_t> scans;
  std::vector<Face> contours;
  for (std::size_t i = 0; i < scene.contours.faces.size(); ++i) {
    if (face_plane(scene.contours, scene.contours.faces[i]).distance(eye) < 0) continue;
    // At the start pose, where nobody has asked yet.
    if (!can_be_triangulated(alone(scene.contours, scene.contours.faces[i]))) continue;
    scans.push_back(scene.contour_scan[i]);
    contours.push_back(scene.contours.faces[i]);
  }
  scene.contours.faces = std::move(contours);
  scene.contour_scan = std::move(scans);
  std::erase_if(scene.splats, [&](const stages::Splat& splat) {
    const Vec3 normal(splat.normal[0], splat.normal[1], splat.normal[2]);
    const Vec3 centre(splat.centre_m[0], splat.centre_m[1], splat.centre_m[2]);
    return normal.dot(eye - centre) < 0;
  });
}

// Points of a drawing, not surfaces: sparse scans would otherwise hide the model behind large spheres.
constexpr float kLargestRadius_m = 0.02f;
// About as many as the drawing has pixels; more take time and memory, and cannot be told apart.
constexpr double kMostPoints = 2e6;

// Of every so many rows and columns one is drawn.
int thinning(const batch::SceneRun& run) {
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < run.products.size(); ++i) {
    const auto& flags = run.products[i].drawn;
    if (run.registrations[i])
      drawn += count_if_parallel(flags.size(), [&](std::size_t k) { return flags[k] != stages::kNotDrawn; });
  }
  return static_cast<int>(std::ceil(std::sqrt(std::max(static_cast<double>(drawn) / kMostPoints, 1.0))));
}

Image8 draw(device::Queue& queue, const batch::SceneRun& run,
            const std::vector<std::optional<batch::ScanRegistration>>& registrations) {
  const int every = thinning(run);
  auto scene = batch::build_render_scene(*run.model, run.products, registrations, {}, 0, every);
  stages::ViewRequest request;
  request.camera = batch::overview_camera(*run.model, 1280, 900);
  request.texture = false;
  keep_fronts(request.camera.centre(), scene);
  for (auto& splat : scene.splats) {
    splat.radius_m = std::min(splat.radius_m, kLargestRadius_m * static_cast<float>(every));
    splat.on_face = false;  // how they lie on the faces is what the figure is about
  }
  stages::RenderOptions options;
  options.samples_per_axis = 2;
  stages::Renderer renderer(queue, scene, options);
  auto view = renderer.render(request);
  for (std::size_t i = 0; i < view.id.size(); ++i)  // on paper
    if (view.id[i] == 0)
      for (std::size_t k = 0; k < 3; ++k) view.colour.pixels[3 * i + k] = 1;
  return batch::to_picture(view.colour);
}

}  // namespace

void write_registration_figures(device::Queue& queue, const batch::SceneRun& run,
                                const std::filesystem::path& folder) {
  auto before = run.registrations;
  for (auto& registration : before)
    if (registration) registration->icp.world_from_scan = registration->start;
  io::write_png(folder / "registration-before.png", draw(queue, run, before));
  io::write_png(folder / "registration-after.png", draw(queue, run, run.registrations));
}

}  // namespace hybrid::report
