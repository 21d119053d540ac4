#include "stages/registration/face_sides.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel_blocks.hpp"
#include "core/suggest.hpp"
#include "stages/registration/sight_lines.hpp"

namespace hybrid::stages {
namespace {

constexpr double kBackRatio = 4;  // a face is turned that is seen so many times as much from behind
// Of one scan's planar area: on the back of a face that is named, and of all of them.
constexpr double kLeastOfFace = 0.01, kLeastOfAll = 0.15;

}  // namespace

FaceSides& FaceSides::operator+=(const FaceSides& other) {
  front_m2.resize(std::max(front_m2.size(), other.front_m2.size()));
  back_m2.resize(front_m2.size());
  for (std::size_t i = 0; i < other.front_m2.size(); ++i) {
    front_m2[i] += other.front_m2[i];
    back_m2[i] += other.back_m2[i];
  }
  return *this;
}

FaceSides face_sides(const ScanEvidence& scan, const ProxyModel& model, const Pose& world_from_scan,
                     double tolerance_m) {
  const std::size_t count = model.polygons().faces.size();
  const auto& shapes = model.shapes().faces;
  const double least_cosine = std::cos(SightOptions().normal_deg * std::numbers::pi / 180);
  const auto of_rays = [&](std::size_t begin, std::size_t end) {
    FaceSides own{std::vector<double>(count), std::vector<double>(count)};
    for (std::size_t i = begin; i < end; ++i) {
      const SightRay& ray = scan.rays[i];
      const Vec3 point = world_from_scan * (ray.range_m * ray.direction);
      const Vec3 normal = world_from_scan.rotate(ray.normal);
      const FaceShape *front = nullptr, *back = nullptr;
      for (const FaceShape& face : shapes) {
        if (std::abs(face.plane.distance(point)) > tolerance_m) continue;
        const double cosine = normal.dot(face.plane.normal);
        if (std::abs(cosine) < least_cosine || face.outside_m(point, 0) > 0) continue;
        (cosine > 0 ? front : back) = &face;
        if (front != nullptr) break;
      }
      if (front != nullptr)
        own.front_m2[front->face] += ray.area_m2;
      else if (back != nullptr)
        own.back_m2[back->face] += ray.area_m2;
    }
    return own;
  };
  constexpr std::size_t kRays = 2048;
  FaceSides sides = sum_blocks<FaceSides>(scan.rays.size(), of_rays, kRays);
  sides += FaceSides{std::vector<double>(count), std::vector<double>(count)};  // of a scan without planes
  return sides;
}

std::vector<std::uint32_t> turned_faces(const FaceSides& sides, const std::vector<double>& least_m2) {
  std::vector<std::uint32_t> turned;
  for (std::uint32_t i = 0; i < sides.back_m2.size(); ++i)
    if (sides.back_m2[i] >= least_m2[i] && sides.back_m2[i] >= kBackRatio * sides.front_m2[i])
      turned.push_back(i);
  std::stable_sort(turned.begin(), turned.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return sides.back_m2[a] > sides.back_m2[b]; });
  return turned;
}

std::vector<std::string> names_of_faces(const PolygonModel& model, const std::vector<std::uint32_t>& faces) {
  std::vector<std::string> names;
  for (const std::uint32_t face : faces) names.push_back(model.faces[face].name);
  return names;
}

std::string diagnose_turned_faces(const ScanEvidence& scan, const ProxyModel& model, const Pose& start,
                                  const AutomaticOptions& options) {
  const FaceSides sides = face_sides(scan, model, start, options.clear_m * start.scale);
  const std::vector<double> least(sides.back_m2.size(), kLeastOfFace * scan.area_m2);
  const auto turned = turned_faces(sides, least);
  double back = 0, front = 0;
  for (const std::uint32_t face : turned) back += sides.back_m2[face] / scan.area_m2;
  for (const double area : sides.front_m2) front += area / scan.area_m2;
  if (back < kLeastOfAll || back + front < options.least_support) return "";
  return fmt::format(
      "under its start {:.0f} % of the planar area lie on faces, but {:.0f} % on backs ({}): corners must go "
      "counter-clockwise seen from where the scanner stands; turn such faces round in the model",
      100 * (front + back), 100 * back, some_of(names_of_faces(model.polygons(), turned)));
}

}  // namespace hybrid::stages
