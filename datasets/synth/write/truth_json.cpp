#include "write/truth_json.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "room/coverage.hpp"
#include "write/files.hpp"

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

Json scan_entry(const Scan& scan) {
  std::array<std::size_t, 3> kinds{};
  for (const Sample& sample : scan.samples) ++kinds[static_cast<std::size_t>(sample.kind)];
  return {{"id", scan.pose.id},
          {"file", "scans/" + scan.pose.id + ".ply"},
          {"world_from_scan", row_major(scan.pose.world_from_scan.matrix())},
          {"truth_image", "truth/" + scan.pose.id + ".exr"},
          {"samples", scan.samples.size()},
          {"columns", scan.samples_of_column.size()},
          {"planar", kinds[0]},
          {"curved", kinds[1]},
          {"mixed", kinds[2]}};
}

}  // namespace

void write_truth_json(const std::filesystem::path& path, const Room& room, const Tracer& tracer,
                      const RoomOptions& options, const std::vector<Scan>& scans,
                      const std::vector<Camera>& photographs, const std::vector<Camera>& held_out_views) {
  Json truth = {{"seed", options.seed},
                {"preset", options.preset.name},
                {"noise_m", options.noise_m},
                {"dropout_share", options.dropout_share},
                {"proxy_error_m", options.proxy_error_m},
                {"room_size_m", numbers(room.size)}};
  for (const char* list : {"scans", "planes", "cameras", "views", "clutter", "openings"})
    truth[list] = Json::array();
  for (const Scan& scan : scans) truth["scans"].push_back(scan_entry(scan));
  for (const Surface& surface : room.mesh.surfaces) {
    if (surface.plane_id == 0) continue;
    Json plane = {{"id", surface.plane_id},
                  {"name", surface.name},
                  {"normal", numbers(surface.normal)},
                  {"offset_m", surface.offset_m},
                  {"proxy_face", surface.proxy_face.empty() ? Json() : Json(surface.proxy_face)}};
    if (!surface.proxy_face.empty()) {
      const std::array<double, 3> seen = seen_shares(room, tracer, surface, photographs);
      plane["seen_by_photographs"] = {{"none", seen[0]}, {"one", seen[1]}, {"more", seen[2]}};
    }
    truth["planes"].push_back(plane);
  }
  for (const Camera& camera : photographs) truth["cameras"].push_back(camera_entry(camera));
  for (const Camera& camera : held_out_views) {
    Json entry = camera_entry(camera);
    entry["image"] = "truth/views/" + camera.name + ".png";
    truth["views"].push_back(entry);
  }
  for (const Clutter& c : room.clutter)
    truth["clutter"].push_back(
        {{"name", c.name}, {"kind", c.kind}, {"low", numbers(c.low)}, {"high", numbers(c.high)}});
  for (const Recess& recess : room.recesses) {
    Json ring = Json::array();
    for (const Vec3& corner : recess.ring(room.size)) ring.push_back(numbers(corner));
    truth["openings"].push_back(
        {{"name", recess.name}, {"face", recess.wall}, {"depth_m", recess.depth_m}, {"ring", ring}});
  }
  write_bytes(path, truth.dump(1) + "\n");
}

}  // namespace synth
