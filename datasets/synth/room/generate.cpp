#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "geometry/random.hpp"
#include "room/room.hpp"
#include "trace/render.hpp"
#include "trace/scanner.hpp"
#include "write/colmap.hpp"
#include "write/files.hpp"
#include "write/images.hpp"
#include "write/meshes.hpp"
#include "write/scene_toml.hpp"
#include "write/truth_json.hpp"

namespace synth {
namespace {

constexpr std::size_t kLandmarks = 5;
constexpr double kPickErrorM = 0.01;

// Corners of the room the scanner sees, spread as widely as can be, picked with a hand's error. The model
// side is the proxy's own vertex, wrong as it may be.
std::vector<Landmark> pick_landmarks(const Room& room, const Tracer& tracer, const ScannerPose& pose,
                                     const RoomOptions& options, std::uint64_t scan_index) {
  const std::vector<Vec3> vertices = proxy_vertices(room, options);
  const Eigen::Isometry3d scan_from_world = pose.world_from_scan.inverse();
  std::vector<std::size_t> visible, picked;
  const auto true_corner = [&](std::size_t k) {
    return Vec3(k & 1 ? room.size.x() : 0, k & 2 ? room.size.y() : 0, k & 4 ? room.size.z() : 0);
  };
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vec3 inside_corner = true_corner(k) + 0.03 * (room.size / 2 - true_corner(k)).cwiseSign();
    if (tracer.sees(pose.world_from_scan.translation(), inside_corner)) visible.push_back(k);
  }
  while (picked.size() < std::min(kLandmarks, visible.size())) {
    double widest = -1;
    std::size_t best = 0;
    for (std::size_t k : visible) {
      double nearest = std::numeric_limits<double>::max();
      for (std::size_t p : picked) nearest = std::min(nearest, (true_corner(k) - true_corner(p)).norm());
      if (std::find(picked.begin(), picked.end(), k) == picked.end() && nearest > widest) {
        widest = nearest;
        best = k;
      }
    }
    picked.push_back(best);
  }
  if (picked.size() < 3) throw std::runtime_error("a scanner sees fewer than three corners of the room");
  Random random(options.seed, purpose::landmarks, scan_index);
  std::vector<Landmark> landmarks;
  for (std::size_t k : picked)
    landmarks.push_back({scan_from_world * true_corner(k) + kPickErrorM * random.normal3(), vertices[k]});
  return landmarks;
}

std::vector<Camera> held_out_cameras(const std::vector<View>& all, const Preset& preset) {
  std::vector<Camera> cameras;
  for (const View& view : all)
    if (view.name == "both-textured" || view.name == "novel-2")
      cameras.push_back(pinhole(view.name, preset.view_width_px, preset.view_height_px, kViewFovDeg, view.eye,
                                view.target));
  return cameras;
}

Summary summarise(const std::string& folder, const RoomOptions& options, const Room& room,
                  const std::vector<Scan>& scans, std::size_t photographs) {
  nlohmann::ordered_json json = {{"scene", folder + "/scene.toml"},
                                 {"truth", folder + "/truth.json"},
                                 {"seed", options.seed},
                                 {"preset", options.preset.name},
                                 {"triangles", room.mesh.triangles.size()},
                                 {"photographs", photographs},
                                 {"scans", nlohmann::ordered_json::array()}};
  std::string text =
      fmt::format("room {:.2f} x {:.2f} x {:.2f} m, {} triangles, {} photographs\n", room.size.x(),
                  room.size.y(), room.size.z(), room.mesh.triangles.size(), photographs);
  for (const Scan& scan : scans) {
    std::array<std::size_t, 3> kinds{};
    for (const Sample& sample : scan.samples) ++kinds[static_cast<std::size_t>(sample.kind)];
    const auto [least, most] =
        std::minmax_element(scan.samples_of_column.begin(), scan.samples_of_column.end());
    json["scans"].push_back({{"id", scan.pose.id}, {"samples", scan.samples.size()}});
    text += fmt::format("scan {}: {} samples in {} columns of {} to {}; {} planar, {} curved, {} mixed\n",
                        scan.pose.id, scan.samples.size(), scan.samples_of_column.size(), *least, *most,
                        kinds[0], kinds[1], kinds[2]);
  }
  text += fmt::format("scene: {}/scene.toml\n", folder);
  return {json.dump(1) + "\n", text};
}

}  // namespace

Summary generate_room(const RoomOptions& options, const std::string& folder) {
  const std::filesystem::path out(folder);
  for (const char* sub : {"scans", "photographs", "cameras", "truth/views"}) make_folder(out / sub);

  const Room room = build_room(options.seed);
  const Tracer tracer(room.mesh);
  const std::vector<Camera> photographs = photograph_cameras(room, options);
  const std::vector<View> scene_views = views(room, photographs);
  const std::vector<Camera> held_out = held_out_cameras(scene_views, options.preset);
  const std::vector<ScannerPose> poses = scanner_poses(room, options.seed);

  write_detail_ply(out / "detail.ply", room.mesh);
  write_proxy_obj(out / "proxy.obj", proxy_vertices(room, options));
  write_colmap(out / "cameras", photographs);

  std::vector<Scan> scans;
  std::vector<std::vector<Landmark>> landmarks;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    scans.push_back(simulate_scan(room, tracer, poses[i], options, i));
    landmarks.push_back(pick_landmarks(room, tracer, poses[i], options, i));
    write_scan_ply(out / "scans" / (poses[i].id + ".ply"), scans.back());
    write_truth_exr(out / "truth" / (poses[i].id + ".exr"), scans.back());
  }
  for (std::size_t i = 0; i < photographs.size(); ++i)
    write_jpeg_or_png(out / "photographs" / photographs[i].name,
                      render(room, tracer, photographs[i], {options.seed, i, 2, 2, true}));
  for (std::size_t i = 0; i < held_out.size(); ++i)
    write_jpeg_or_png(out / "truth" / "views" / (held_out[i].name + ".png"),
                      render(room, tracer, held_out[i],
                             {options.seed, 50 + i, options.preset.truth_view_samples_per_side, 2, false}));
  write_truth_json(out / "truth.json", room, tracer, options, scans, photographs, held_out);
  // Last: a folder with a scene file is a whole one.
  write_scene_toml(out / "scene.toml", options, poses, landmarks, scene_views);
  return summarise(folder, options, room, scans, photographs.size());
}

}  // namespace synth
