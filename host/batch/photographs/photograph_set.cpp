#include "batch/photographs/photograph_set.hpp"

#include <algorithm>

#include "batch/photographs/photograph_files.hpp"
#include "core/error.hpp"
#include "core/suggest.hpp"
#include "io/scene/map_shift.hpp"

namespace hybrid::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The rigid part of cam_from_world for a world that is a similarity away from the cameras' own: the camera's
// centre moves with the world's scale, its image does not change.
Pose camera_in_world(const Pose& cam_from_photographs, const Pose& world_from_photographs) {
  Pose world_from_cam = world_from_photographs * cam_from_photographs.inverse();
  world_from_cam.scale = 1;
  return world_from_cam.inverse();
}

// In salvage the photographs that cannot be read leave the set.
void read_pixels(bool salvage, std::size_t decoded_bytes, PhotographSet& set) {
  std::uint64_t all_bytes = 0;
  std::vector<KeptPhotographs::File> files;
  for (std::size_t i = 0; i < set.cameras.size(); ++i) {
    const Camera& camera = set.cameras[i].camera;
    all_bytes += 3 * static_cast<std::uint64_t>(camera.width) * static_cast<std::uint64_t>(camera.height);
    files.push_back({set.files[i], camera.width, camera.height});
  }
  set.pixels = std::make_shared<KeptPhotographs>(decoded_bytes, all_bytes);
  std::vector<bool> lost(files.size());
  set.pixels->add(files, [&](std::size_t i, const Error& error) {
    if (!salvage) fail_input("{}; or use the other photographs with --salvage", error.what());
    set.warnings.push_back(fmt::format("photograph {} is left out: {}", set.cameras[i].name, error.what()));
    lost[i] = true;
  });
  PhotographSet good;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (lost[i]) continue;
    good.cameras.push_back(std::move(set.cameras[i]));
    good.files.push_back(std::move(set.files[i]));
  }
  if (good.cameras.empty()) fail_input("none of the {} photographs can be read", files.size());
  good.pixels = std::move(set.pixels);
  good.warnings = std::move(set.warnings);
  set = std::move(good);
}

std::string name_of(const io::ScenePhotographPick& pick, std::size_t number) {
  return fmt::format("landmark {} (line {})", number + 1, pick.line);
}

stages::PhotographPick pick_of(const io::ScenePhotographPick& picked, const PolygonModel& model,
                               const std::vector<Photograph>& cameras) {
  stages::PhotographPick pick;
  if (picked.photograph.empty())
    pick.point = *picked.point;
  else
    pick.photograph = photograph_index(cameras, picked.photograph);
  if (picked.pixel) pick.pixel = Vec2((*picked.pixel)[1] + 0.5, (*picked.pixel)[0] + 0.5);
  pick.snap = picked.snap;
  if (picked.model) {
    pick.point_in_model = *picked.model;
    return pick;
  }
  const auto vertex = static_cast<std::size_t>(*picked.vertex);
  if (vertex >= model.vertices.size())
    fail_input("vertex {}: the model has {} vertices (0-based, in file order)", vertex,
               model.vertices.size());
  pick.point_in_model = model.vertices[vertex];
  return pick;
}

Json landmark_json(const io::SceneFile::Photographs& section, const stages::PhotographFit& fit) {
  Json picks = Json::array();
  for (std::size_t i = 0; i < section.landmarks.size(); ++i) {
    const auto& picked = section.landmarks[i];
    Json row = {{"landmark", i + 1}};
    if (!picked.photograph.empty()) row["photograph"] = picked.photograph;
    if (picked.pixel) {
      row["pixel"] = *picked.pixel;
      row["residual_px"] = fit.residual_px[i];
    }
    row["residual_m"] = fit.residual_m[i];
    if (fit.left_out == i) row["left_out"] = true;
    picks.push_back(std::move(row));
  }
  return {{"world_from_photographs", row_major(fit.world_from_photographs)},
          {"scale", fit.world_from_photographs.scale},
          {"rms_m", fit.rms_m},
          {"picks", picks}};
}

}  // namespace

PhotographSet read_photographs(const io::SceneFile::Photographs& section, bool salvage,
                               std::size_t decoded_bytes) {
  PhotographSet set;
  if (!section.e57_files.empty()) {
    set.pixels = std::make_shared<KeptPhotographs>(decoded_bytes);
    E57PhotographSet found = read_e57_photographs(section.e57_files, salvage);
    set.cameras = std::move(found.cameras);
    for (Image8& image : found.pixels) set.pixels->add(std::move(image));
    set.anchors = std::move(found.anchors);
    set.frames = std::move(found.frames);
    set.warnings = std::move(found.warnings);
    set.files = section.e57_files;
    return set;
  }
  const io::CameraFile cameras = io::read_cameras(section.cameras, section.images);
  for (const std::string& note : cameras.notes)
    set.warnings.push_back(section.cameras.path.string() + ": " + note);
  set.cameras = cameras.photographs;
  PhotographFiles files = photograph_files(section, set.cameras, salvage);
  if (!files.note.empty()) set.warnings.push_back(files.note);
  set.files = std::move(files.all);
  read_pixels(salvage, decoded_bytes, set);
  if (section.world_from_photographs) {
    const Pose world_from_photographs = pose_from_row_major(*section.world_from_photographs);
    for (Photograph& photograph : set.cameras)
      photograph.cam_from_world = camera_in_world(photograph.cam_from_world, world_from_photographs);
  } else if (section.landmarks.empty()) {
    set.frame_hint = cameras.frame_hint;
    io::take_off_shift(section.shift, set.cameras);
  }
  return set;
}

void place_by_landmarks(const io::SceneFile::Photographs& section, const PolygonModel& model,
                        double snap_tolerance_m, PhotographSet& photographs) {
  if (section.landmarks.empty()) return;
  std::vector<stages::PhotographPick> picks;
  for (std::size_t i = 0; i < section.landmarks.size(); ++i) {
    const auto& picked = section.landmarks[i];
    const std::string name = name_of(picked, i);
    picks.push_back(
        with_context("photographs: " + name, [&] { return pick_of(picked, model, photographs.cameras); }));
    picks.back().name = name;
  }
  photographs.landmarks = with_context("photographs", [&] {
    return stages::fit_photographs(model, photographs.cameras, picks, snap_tolerance_m);
  });
  const std::string& warning = photographs.landmarks->warning;
  if (!warning.empty()) photographs.warnings.push_back("photographs: " + warning);
  for (Photograph& photograph : photographs.cameras)
    photograph.cam_from_world =
        camera_in_world(photograph.cam_from_world, photographs.landmarks->world_from_photographs);
}

void place_photographs(const io::SceneFile::Photographs& section, const std::vector<PlacedScan>& scans,
                       PhotographSet& photographs) {
  photographs.placed_with.clear();
  for (std::size_t i = 0; i < photographs.anchors.size(); ++i) {
    const E57Anchor& anchor = photographs.anchors[i];
    PlacedCamera placed;
    if (section.world_from_photographs)
      placed = {camera_in_world(anchor.file_from_cam.inverse(),
                                pose_from_row_major(*section.world_from_photographs)),
                "world_from_photographs"};
    else
      placed = place_camera(anchor, photographs.frames, scans);
    photographs.cameras[i].cam_from_world = placed.cam_from_world;
    photographs.placed_with.push_back(placed.with);
  }
  if (!photographs.anchors.empty()) io::take_off_shift(section.shift, photographs.cameras);
}

std::size_t photograph_index(const std::vector<Photograph>& cameras, const std::string& name) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (cameras[i].name == name) return i;
    names.push_back(cameras[i].name);
  }
  const std::string_view nearest = nearest_name(name, names);
  fail_input("photograph '{}': no camera of that name in the camera model, which has {}{}", name,
             names.size(), nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
}

void describe_photographs(const io::SceneFile::Photographs& section, const PhotographSet& photographs,
                          Json& summary) {
  for (std::size_t i = 0; i < photographs.placed_with.size(); ++i)
    summary["photographs"].push_back(
        {{"name", photographs.cameras[i].name}, {"placed_with", photographs.placed_with[i]}});
  if (photographs.landmarks) summary["photograph_landmarks"] = landmark_json(section, *photographs.landmarks);
}

}  // namespace hybrid::batch
