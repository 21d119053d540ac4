#include "report/figures.hpp"

#include <algorithm>
#include <cmath>

#include "io/picture.hpp"

namespace hybrid::report {
namespace {

// Leaves out faces and samples that turn their back to the eye, so that one looks into the rooms from
// outside.
void keep_fronts(const Vec3& eye, stages::RenderScene& scene) {
  std::erase_if(scene.proxy.faces,
                [&](const Face& face) { return face_plane(scene.proxy, face).distance(eye) < 0; });
  std::erase_if(scene.splats, [&](const stages::Splat& splat) {
    const Vec3 normal(splat.normal[0], splat.normal[1], splat.normal[2]);
    const Vec3 centre(splat.centre_m[0], splat.centre_m[1], splat.centre_m[2]);
    return normal.dot(eye - centre) < 0;
  });
}

// Points of a drawing, not surfaces: sparse scans would otherwise hide the model behind large spheres.
constexpr float kLargestRadius_m = 0.02f;

Image8 draw(device::Queue& queue, const batch::SceneRun& run,
            const std::vector<std::optional<batch::ScanRegistration>>& registrations) {
  auto scene = batch::build_render_scene(*run.model, run.products, registrations, {});
  stages::ViewRequest request;
  request.camera = overview_camera(*run.model, 1280, 900);
  request.texture = false;
  keep_fronts(request.camera.centre(), scene);
  for (auto& splat : scene.splats) {
    splat.radius_m = std::min(splat.radius_m, kLargestRadius_m);
    splat.on_face = false;  // how they lie on the faces is what the figure is about
  }
  stages::RenderOptions options;
  options.samples_per_axis = 2;
  stages::Renderer renderer(queue, scene, options);
  return batch::to_picture(renderer.render(request).colour);
}

}  // namespace

Photograph overview_camera(const PolygonModel& model, int width, int height) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : model.vertices) box.extend(vertex);
  const double fov_deg = 40;
  const Vec3 direction = Vec3(-0.45, -0.75, 0.85).normalized();
  const double distance = 0.5 * box.diagonal().norm() / std::sin(0.5 * fov_deg * M_PI / 180);
  return look_at(box.center() + 0.9 * distance * direction, box.center(), Vec3::UnitZ(), fov_deg, width,
                 height);
}

void write_registration_figures(device::Queue& queue, const batch::SceneRun& run,
                                const std::filesystem::path& folder) {
  auto before = run.registrations;
  for (auto& registration : before)
    if (registration) registration->icp.world_from_scan = registration->start;
  io::write_png(folder / "registration-before.png", draw(queue, run, before));
  io::write_png(folder / "registration-after.png", draw(queue, run, run.registrations));
}

}  // namespace hybrid::report
