#include "world/generate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "geometry/random.hpp"
#include "trace/render.hpp"
#include "trace/scanner.hpp"
#include "world/landmarks.hpp"
#include "write/colmap.hpp"
#include "write/e57_file.hpp"
#include "write/files.hpp"
#include "write/images.hpp"
#include "write/meshes.hpp"
#include "write/scan_stream.hpp"
#include "write/scene_toml.hpp"
#include "write/truth_json.hpp"

namespace synth {
namespace {

constexpr std::uint64_t kHeldOutPictures = 50, kPanoramas = 80;  // their indices start here

using TakePicture = std::function<Picture8(const Camera&, const RenderOptions&)>;

std::vector<Camera> held_out_cameras(const World& world, const Preset& preset) {
  std::vector<Camera> cameras;
  for (const View& view : world.views) {
    if (!view.held_out) continue;
    cameras.push_back(
        pinhole(view.name, preset.view_width_px, preset.view_height_px, kViewFovDeg, view.eye, view.target));
    cameras.back().exposure = view.exposure;
  }
  return cameras;
}

// What a photogrammetrist hands over: directions off by camera_error pixels.
std::vector<Camera> erring(std::vector<Camera> cameras, const Options& options) {
  if (options.camera_error == 0) return cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    Random random(options.seed, purpose::camera_error, i);
    const Vec3 turn = options.camera_error / cameras[i].focal_px * random.normal3();
    cameras[i].camera_from_world_rotation =
        Eigen::AngleAxisd(turn.norm(), turn.normalized()) * cameras[i].camera_from_world_rotation;
    // A metre across the scene in sight at ten metres is as much as focal / 10 pixels.
    cameras[i].eye += 10 * options.camera_error / cameras[i].focal_px * 0.3 * random.normal3();
  }
  return cameras;
}

// What a scanner's own camera puts together, and the mask that takes the tripod out.
E57Picture take_panorama(const ScannerPose& pose, const Preset& preset, const TakePicture& take,
                         std::uint64_t index, const Options& options) {
  const int width = preset.photograph_width_px * 5 / 4 * 2;
  E57Picture picture{panorama(pose.id + "-panorama.jpg", width, pose.world_from_scan.rotation(),
                              pose.world_from_scan.translation()),
                     {},
                     {}};
  picture.jpeg = encoded(".jpg", take(picture.camera, {options.seed, kPanoramas + index, 2, 2,
                                                       development(options, kPanoramas + index)}));
  Picture8 mask{picture.camera.width_px, picture.camera.height_px, {}};
  mask.rgb.assign(3 * static_cast<std::size_t>(mask.width_px) * static_cast<std::size_t>(mask.height_px), 0);
  const int whole = mask.height_px * 5 / 6;  // down to 60 degrees below the horizon, as the scanner
  std::fill_n(mask.rgb.begin(), std::ptrdiff_t{3} * mask.width_px * whole, std::uint8_t{255});
  picture.mask_png = encoded(".png", mask);
  return picture;
}

std::vector<ScanCounts> write_scans(const std::filesystem::path& out, const World& world,
                                    const Tracer& tracer, const TakePicture& take, const Options& options) {
  std::vector<ScanCounts> scans;
  for (std::size_t i = 0; i < world.scanners.size(); ++i) {
    const ScannerPose& pose = world.scanners[i];
    const auto file = open_scan_file(out / "scans" / scan_file_name(pose, options), pose, options);
    const auto truth = open_truth_file(out / "truth" / (pose.id + ".exr"), pose, options);
    scans.push_back(simulate_scan(world, tracer, pose, options, world.first_scanner + i,
                                  [&](const std::vector<Sample>& column) {
                                    file->add(column);
                                    truth->add(column);
                                  }));
    scans.back().samples = file_samples(pose, options, scans.back().returns);
    if (auto* e57 = dynamic_cast<E57ScanFile*>(file.get()); e57 && !world.photographs.empty())
      e57->attach(take_panorama(pose, options.preset, take, world.first_scanner + i, options));
    file->finish();
    truth->finish();
  }
  return scans;
}

Summary summarise(const std::string& folder, const Options& options, const World& world,
                  const std::vector<ScanCounts>& scans) {
  nlohmann::ordered_json json = {{"scene", folder + "/scene.toml"},
                                 {"truth", folder + "/truth.json"},
                                 {"seed", options.seed},
                                 {"preset", options.preset.name},
                                 {"triangles", world.mesh.triangles.size()},
                                 {"photographs", world.photographs.size()},
                                 {"scans", nlohmann::ordered_json::array()}};
  std::string text =
      fmt::format("{} {:.2f} x {:.2f} x {:.2f} m, {} triangles, {} photographs\n", world.kind, world.size.x(),
                  world.size.y(), world.size.z(), world.mesh.triangles.size(), world.photographs.size());
  for (const ScanCounts& scan : scans) {
    const auto& kinds = scan.returns_of_kind;
    json["scans"].push_back({{"id", scan.pose.id}, {"samples", scan.returns}});
    text += fmt::format("scan {}: {} samples in {} columns of {} to {}; {} planar, {} curved, {} mixed",
                        scan.pose.id, scan.returns, scan.columns, scan.shortest_column, scan.longest_column,
                        kinds[0], kinds[1], kinds[2]);
    text += kinds[3] > 0 ? fmt::format(", {} ghosts\n", kinds[3]) : "\n";
  }
  text += fmt::format("scene: {}/scene.toml\n", folder);
  return {json.dump(1) + "\n", text};
}

}  // namespace

double estimate_bytes(const World& world, const Options& options) {
  const Preset& p = options.preset;
  double bytes = 64.0 * static_cast<double>(world.mesh.triangles.size()) + 1e6;
  for (const ScannerPose& pose : world.scanners) {  // points, truth, and what is on its way
    const ScanFormat format = format_of(pose, options);
    const double of_a_point = format == ScanFormat::ply || format == ScanFormat::e57 ? 16
                              : format == ScanFormat::ptx                            ? 33
                                                                                     : 16 + 24;
    bytes += static_cast<double>(p.scan_columns) * p.scan_rows * (of_a_point + 5 + 12);
  }
  bytes +=
      0.8 * p.photograph_width_px * p.photograph_height_px * static_cast<double>(world.photographs.size());
  if (options.scan_format == ScanFormat::e57)  // the photographs twice, and panoramas
    bytes += 0.8 * p.photograph_width_px *
             (static_cast<double>(p.photograph_height_px) * static_cast<double>(world.photographs.size()) +
              3.2 * p.photograph_width_px * static_cast<double>(world.scanners.size()));
  return bytes + 3.0 * p.view_width_px * p.view_height_px * static_cast<double>(world.views.size());
}

Summary generate(const World& world, const Options& options, const std::string& folder) {
  const std::filesystem::path out(folder);
  check_free_space(out, estimate_bytes(world, options));
  for (const char* sub : {"scans", "truth"}) make_folder(out / sub);

  const Tracer tracer(world.mesh);
  const std::vector<Camera> held_out = held_out_cameras(world, options.preset);
  write_detail_ply(out / "detail.ply", world.mesh);
  write_proxy_obj(out / "proxy.obj", world.proxy);
  if (!world.photographs.empty()) {
    for (const char* sub : {"photographs", "cameras", "truth/views"}) make_folder(out / sub);
    write_colmap(out / "cameras", erring(world.photographs, options));
  }

  std::vector<std::vector<Landmark>> landmarks;
  for (std::size_t i = 0; i < world.scanners.size(); ++i)
    landmarks.push_back(
        pick_landmarks(world, tracer, world.scanners[i], options.seed, world.first_scanner + i));
  std::optional<IndirectLight> indirect;
  if (world.sun && !world.photographs.empty())
    indirect.emplace(world, tracer, options.preset.light_step_m, options.preset.light_rays);
  const auto picture = [&](const Camera& camera, const RenderOptions& how) {
    return render(world, tracer, indirect ? &*indirect : nullptr, camera, how);
  };
  const std::vector<ScanCounts> scans = write_scans(out, world, tracer, picture, options);
  const std::vector<Camera> told = erring(world.photographs, options);
  std::vector<E57Picture> embedded;
  for (std::size_t i = 0; i < world.photographs.size(); ++i) {
    const std::string jpeg =
        encoded(".jpg", picture(world.photographs[i], {options.seed, i, 2, 2, development(options, i)}));
    write_bytes(out / "photographs" / world.photographs[i].name, jpeg);
    if (options.scan_format == ScanFormat::e57) embedded.push_back({told[i], jpeg, {}});
  }
  if (!embedded.empty()) write_e57_pictures(out / "photographs.e57", embedded, options.seed);
  Development clean;
  clean.noise = false;
  for (std::size_t i = 0; i < held_out.size(); ++i)
    write_jpeg_or_png(out / "truth" / "views" / (held_out[i].name + ".png"),
                      picture(held_out[i], {options.seed, kHeldOutPictures + i,
                                            options.preset.truth_view_samples_per_side, 2, clean}));
  write_truth_json(out / "truth.json", world, tracer, options, scans, held_out);
  // Last: a folder with a scene file is a whole one.
  write_scene_toml(out / "scene.toml", world, options, landmarks);
  return summarise(folder, options, world, scans);
}

}  // namespace synth
