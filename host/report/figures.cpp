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

// Without a model they are the surfaces.
constexpr float kSurface_m = 0.1f;

// Of every so many rows and columns one is drawn.
int thinning(std::size_t samples) {
  return static_cast<int>(std::ceil(std::sqrt(std::max(static_cast<double>(samples) / kMostPoints, 1.0))));
}

int thinning(const batch::SceneRun& run) {
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < run.products.size(); ++i) {
    const auto& flags = run.products[i].drawn;
    if (run.registrations[i])
      drawn += count_if_parallel(flags.size(), [&](std::size_t k) { return flags[k] != stages::kNotDrawn; });
  }
  return thinning(drawn);
}

constexpr int kWidth = 1280, kHeight = 900;

using Registrations = std::vector<std::optional<batch::ScanRegistration>>;

stages::RenderScene scene_of(const batch::SceneRun& run, const Registrations& registrations, int every) {
  return batch::build_render_scene(*run.model, run.products, registrations, {},
                                   batch::world_contours(run.products, registrations), 0, every);
}

Image8 draw(device::Queue& queue, stages::RenderScene scene, const Photograph& camera, float largest_m) {
  stages::ViewRequest request;
  request.camera = camera;
  request.texture = false;
  keep_fronts(request.camera.centre(), scene);
  for (auto& splat : scene.splats) {
    splat.radius_m = std::min(splat.radius_m, largest_m);
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

// Without a model there are no surfaces but the scans': all their measured samples.
stages::RenderScene scans_alone(const batch::SceneRun& run) {
  std::size_t measured = 0;
  std::vector<std::vector<std::uint8_t>> flags(run.products.size());
  for (std::size_t i = 0; i < run.products.size(); ++i) {
    if (!run.registrations[i]) continue;
    const auto& product = run.products[i];
    flags[i].assign(product.image.count(), stages::kNotDrawn);
    parallel_for(
        flags[i].size(),
        [&](std::size_t k) {
          if (product.image.mask[k] == kMeasured && product.stray[k] == stages::kNotStray)
            flags[i][k] = stages::kDrawn;
        },
        4096);
    measured +=
        count_if_parallel(flags[i].size(), [&](std::size_t k) { return flags[i][k] == stages::kDrawn; });
  }
  const int every = thinning(measured);
  stages::RenderScene scene;
  for (std::size_t i = 0; i < run.products.size(); ++i) {
    if (!run.registrations[i]) continue;
    const Pose pose = run.registrations[i]->world_from_scan();
    scene.scanners.push_back(pose.translation);
    const auto splats = stages::make_splats(run.products[i].image, run.products[i].segmentation, flags[i],
                                            pose, static_cast<std::uint32_t>(i), every);
    scene.splats.insert(scene.splats.end(), splats.begin(), splats.end());
  }
  return scene;
}

// Where nine tenths of the samples are: stray planes run to the horizon.
Eigen::AlignedBox3d box_of(const std::vector<stages::Splat>& splats) {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  std::vector<double> along(splats.size());
  for (int axis = 0; axis < 3 && !splats.empty(); ++axis) {
    for (std::size_t k = 0; k < splats.size(); ++k) along[k] = static_cast<double>(splats[k].centre_m[axis]);
    const auto quantile = [&](double share) {
      const auto at =
          along.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(along.size() - 1));
      std::nth_element(along.begin(), at, along.end());
      return *at;
    };
    low[axis] = quantile(0.05);
    high[axis] = quantile(0.95);
  }
  const Vec3 margin = 0.1 * (high - low) + Vec3::Constant(0.1);
  return {low - margin, high + margin};
}

void draw_scans_alone(device::Queue& queue, const batch::SceneRun& run, const std::filesystem::path& folder) {
  const auto scene = scans_alone(run);
  const auto box = box_of(scene.splats);
  io::write_png(folder / "registration-after.png",
                draw(queue, scene, batch::overview_camera(box, kWidth, kHeight), kSurface_m));
  io::write_png(folder / "registration-plan.png",
                draw(queue, scene, batch::plan_camera(box, kWidth, kHeight), kSurface_m));
}

}  // namespace

void write_registration_figures(device::Queue& queue, const batch::SceneRun& run,
                                const std::filesystem::path& folder) {
  // Of an earlier run of a scene that had a model, or none, since.
  std::filesystem::remove(folder / (run.model ? "registration-plan.png" : "registration-before.png"));
  if (!run.model) return draw_scans_alone(queue, run, folder);
  const int every = thinning(run);
  const float radius_m = kLargestRadius_m * static_cast<float>(every);
  const auto camera = batch::overview_camera(*run.model, kWidth, kHeight);
  auto before = run.registrations;
  for (auto& registration : before)
    if (registration) registration->icp.world_from_scan = registration->start;
  io::write_png(folder / "registration-before.png",
                draw(queue, scene_of(run, before, every), camera, radius_m));
  io::write_png(folder / "registration-after.png",
                draw(queue, scene_of(run, run.registrations, every), camera, radius_m));
}

}  // namespace hybrid::report
