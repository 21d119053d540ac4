#include "io/scene/map_shift.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace hybrid::io {
namespace {

void take_off_shift(const Vec3& shift, SceneClip& clip) {
  if (clip.in_scan_frame) return;
  if (auto* box = std::get_if<SceneClip::Box>(&clip.shape)) {
    if (!is_on_map((box->low + box->high) / 2, shift)) return;
    box->low -= shift;
    box->high -= shift;
  } else if (auto* half = std::get_if<SceneClip::HalfSpace>(&clip.shape)) {
    const double along = half->normal.dot(shift);
    if (std::abs(along) >= kLeastMapShift_m && std::abs(half->offset_m - along) < std::abs(half->offset_m))
      half->offset_m -= along;
  } else if (auto* prism = std::get_if<SceneClip::Prism>(&clip.shape)) {
    Vec2 middle = Vec2::Zero();
    for (const Vec2& corner : prism->polygon) middle += corner / static_cast<double>(prism->polygon.size());
    const Vec3 plan(shift.x(), shift.y(), 0);
    if (!is_on_map({middle.x(), middle.y(), 0}, plan)) return;
    for (Vec2& corner : prism->polygon) corner -= shift.head<2>();
    prism->low -= shift.z();
    prism->high -= shift.z();
  }
}

}  // namespace

bool is_on_map(const Vec3& point, const Vec3& shift) {
  return shift.norm() >= kLeastMapShift_m && (point - shift).squaredNorm() < point.squaredNorm();
}

Vec3 off_map(const Vec3& point, const Vec3& shift) {
  return is_on_map(point, shift) ? Vec3(point - shift) : point;
}

void take_off_shift(SceneFile& scene) {
  const Vec3& shift = scene.shift;
  if (shift.norm() < kLeastMapShift_m) return;
  for (SceneScan& scan : scene.scans)
    for (SceneLandmark& landmark : scan.landmarks)
      if (landmark.model) landmark.model = off_map(*landmark.model, shift);
  for (SceneView& view : scene.views) {
    view.eye = off_map(view.eye, shift);
    view.target = off_map(view.target, shift);
  }
  for (SceneHole& hole : scene.edits.holes)
    for (Vec3& corner : hole.world) corner = off_map(corner, shift);
  for (SceneClip& clip : scene.edits.clips) take_off_shift(shift, clip);
  if (!scene.photographs) return;
  for (ScenePhotographPick& pick : scene.photographs->landmarks)
    if (pick.model) pick.model = off_map(*pick.model, shift);
  if (auto& matrix = scene.photographs->world_from_photographs) {
    const Vec3 translation = off_map({(*matrix)[3], (*matrix)[7], (*matrix)[11]}, shift);
    for (int row = 0; row < 3; ++row) (*matrix)[static_cast<std::size_t>(4 * row + 3)] = translation[row];
  }
}

bool take_off_shift(const Vec3& shift, PolygonModel& model) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : model.vertices) box.extend(vertex);
  if (box.isEmpty() || !is_on_map(box.center(), shift)) return false;
  for (Vec3& vertex : model.vertices) vertex -= shift;
  return true;
}

void take_off_shift(const Vec3& shift, std::vector<Photograph>& cameras) {
  for (Photograph& photograph : cameras) {
    const Vec3 centre = photograph.centre();
    photograph.cam_from_world.translation = -(photograph.cam_from_world.rotation * off_map(centre, shift));
  }
}

}  // namespace hybrid::io
