#include "write/truth_json.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "world/coverage.hpp"
#include "write/files.hpp"
#include "write/scan_stream.hpp"

namespace synth {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Json row_major(const Eigen::Matrix4d& matrix) {
  Json list = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) list.push_back(matrix(row, column));
  return list;
}

Json camera_entry(const Camera& camera) {
  Eigen::Matrix4d world_from_camera = Eigen::Matrix4d::Identity();
  world_from_camera.topLeftCorner<3, 3>() = camera.camera_from_world_rotation.transpose();
  world_from_camera.topRightCorner<3, 1>() = camera.eye;
  return {{"name", camera.name},
          {"size_px", {camera.width_px, camera.height_px}},
          {"model", "RADIAL"},
          {"parameters", {camera.focal_px, camera.centre_x_px, camera.centre_y_px, camera.k1, camera.k2}},
          {"world_from_camera", row_major(world_from_camera)}};
}

Json scan_entry(const ScanCounts& scan, const Options& options) {
  Json entry = {{"id", scan.pose.id},
                {"file", "scans/" + scan_file_name(scan.pose, options)},
                {"world_from_scan", row_major(scan.pose.world_from_scan.matrix())},
                {"truth_image", "truth/" + scan.pose.id + ".exr"},
                {"samples", scan.samples},
                {"columns", scan.columns},
                {"planar", scan.returns_of_kind[0]},
                {"curved", scan.returns_of_kind[1]},
                {"mixed", scan.returns_of_kind[2]}};
  if (format_of(scan.pose, options) != ScanFormat::ply)
    entry["returns"] = scan.returns;  // `samples` counts the grid's places
  if (scan.returns_of_kind[3] > 0) entry["ghost"] = scan.returns_of_kind[3];
  return entry;
}

Json options_entry(const World& world, const Options& options) {
  Json truth = {{"seed", options.seed},
                {"preset", options.preset.name},
                {"noise_m", options.scanner.noise_m},
                {"dropout_share", options.scanner.dropout_share},
                {"proxy_error_m", options.proxy_error_m},
                {world.kind + "_size_m", numbers(world.size)}};
  if (world.kind == "room") return truth;
  truth["noise_per_m"] = options.scanner.noise_per_m;
  truth["incidence_gain"] = options.scanner.incidence_gain;
  truth["camera_error_px"] = options.camera_error;
  truth["photograph_variation"] = options.photograph_variation;
  return truth;
}

const ProxyFace* face_named(const World& world, const std::string& name) {
  for (const ProxyFace& face : world.proxy.faces)
    if (face.name == name) return &face;
  return nullptr;
}

}  // namespace

void write_truth_json(const std::filesystem::path& path, const World& world, const Tracer& tracer,
                      const Options& options, const std::vector<ScanCounts>& scans,
                      const std::vector<Camera>& held_out_views) {
  Json truth = options_entry(world, options);
  for (const char* list : {"scans", "planes", "cameras", "views", "clutter", "openings"})
    truth[list] = Json::array();
  for (const ScanCounts& scan : scans) truth["scans"].push_back(scan_entry(scan, options));
  std::set<int> told;  // surfaces may share a plane
  for (const Surface& surface : world.mesh.surfaces) {
    if (surface.plane_id == 0 || !told.insert(surface.plane_id).second) continue;
    Json plane = {{"id", surface.plane_id},
                  {"name", surface.name},
                  {"normal", numbers(surface.normal)},
                  {"offset_m", surface.offset_m},
                  {"proxy_face", surface.proxy_face.empty() ? Json() : Json(surface.proxy_face)}};
    if (!surface.proxy_face.empty()) {
      const std::array<double, 3> seen = seen_shares(world, tracer, surface);
      plane["seen_by_photographs"] = {{"none", seen[0]}, {"one", seen[1]}, {"more", seen[2]}};
      if (options.proxy_error_m > 0) plane["face_error_m"] = face_named(world, surface.proxy_face)->error_m;
    }
    truth["planes"].push_back(plane);
  }
  for (const Camera& camera : world.photographs) truth["cameras"].push_back(camera_entry(camera));
  for (const Camera& camera : held_out_views) {
    Json entry = camera_entry(camera);
    entry["image"] = "truth/views/" + camera.name + ".png";
    truth["views"].push_back(entry);
  }
  for (const Clutter& c : world.clutter)
    truth["clutter"].push_back(
        {{"name", c.name}, {"kind", c.kind}, {"low", numbers(c.low)}, {"high", numbers(c.high)}});
  for (const Opening& opening : world.openings) {
    Json ring = Json::array();
    for (const Vec3& corner : opening.ring) ring.push_back(numbers(corner));
    truth["openings"].push_back(
        {{"name", opening.name}, {"face", opening.face}, {"depth_m", opening.depth_m}, {"ring", ring}});
  }
  write_bytes(path, truth.dump(1) + "\n");
}

}  // namespace synth
