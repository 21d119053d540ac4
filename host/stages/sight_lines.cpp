#include "stages/sight_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "shared/params_ray_cast.h"
#include "stages/render_geometry.hpp"

namespace hybrid::stages {
namespace {

// What a sample counts that no face supports, and how much of all area one face can cost: openings exist.
constexpr double kInFront = -0.1, kThrough = -0.5, kMostPerFace = 0.3;

void store(const Vec3& v, float* to) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v(k));
}

struct Hit {
  double height = 0;  // of the sample over the face, towards the scanner positive
  std::uint32_t face = 0;
  bool any = false, front = false, compatible = false;
};

// Area-weighted median of the heights near each face, within the options' offset.
std::map<std::uint32_t, double> face_offsets(const std::vector<SightRay>& rays, const std::vector<Hit>& hits,
                                             const SightOptions& options, std::size_t stride) {
  std::map<std::uint32_t, std::vector<std::pair<double, double>>> heights;
  for (std::size_t k = 0; k < hits.size(); ++k)
    if (hits[k].front && hits[k].compatible &&
        std::abs(hits[k].height) < options.offset_m + options.tolerance_m)
      heights[hits[k].face].emplace_back(hits[k].height, rays[k * stride].area_m2);
  std::map<std::uint32_t, double> offsets;
  for (auto& [face, list] : heights) {
    std::sort(list.begin(), list.end());
    double total = 0, sum = 0;
    for (const auto& [height, area] : list) total += area;
    for (const auto& [height, area] : list)
      if ((sum += area) >= total / 2) {
        offsets[face] = std::clamp(height, -options.offset_m, options.offset_m);
        break;
      }
  }
  return offsets;
}

Sight judge(const Hit& hit, double offset, const SightOptions& options) {
  if (!hit.any) return Sight::nothing;
  if (!hit.front && !options.backs) return Sight::nothing;
  const double height = hit.height - offset;
  if (!hit.front) return std::abs(height) > options.clear_m ? Sight::behind : Sight::near;
  if (std::abs(height) < options.tolerance_m) return hit.compatible ? Sight::supported : Sight::near;
  if (height > options.clear_m) return Sight::in_front;
  if (height < -options.clear_m) return Sight::through;
  return Sight::near;
}

}  // namespace

SightCaster::SightCaster(device::Queue& queue, const ProxyModel& model)
    : queue_(queue), origin_(model.sights().origin), bvh_(upload_bvh(queue, model.sights().bvh, {})) {
  for (const Face& face : model.polygons().faces) planes_.push_back(face_plane(model.polygons(), face));
}

std::vector<SightLine> SightCaster::cast(const std::vector<SightRay>& rays, const Pose& world_from_scan,
                                         const SightOptions& options, std::size_t stride) {
  const std::size_t count = (rays.size() + stride - 1) / stride;
  if (count == 0) return {};
  const Mat3 rotation = world_from_scan.rotation.toRotationMatrix();
  std::vector<float> directions(3 * count);
  for (std::size_t k = 0; k < count; ++k) store(rotation * rays[k * stride].direction, &directions[3 * k]);
  RayCastParams params{};
  store(world_from_scan.translation - origin_, params.camera.centre);
  params.cols = static_cast<std::uint32_t>(count);
  params.rows = 1;
  params.root = bvh_.root;
  auto distance = queue_.array<float>(count);
  auto id = queue_.array<std::uint32_t>(count);
  const auto no_surface = queue_.array<float>(0);
  queue_.launch("ray_cast", queue_.kernel("ray_cast", {{"VW", queue_.vector_width()}}),
                packet_grid(queue_.vector_width(), count, 1), params, bvh_.nodes, bvh_.triangles,
                bvh_.spheres, bvh_.surfaces, queue_.array(directions), distance, id, no_surface);
  const auto ids = queue_.read(id);
  const auto predicted = queue_.read(distance);

  std::vector<Hit> hits(count);
  const double compatible = std::cos(options.normal_deg * std::numbers::pi / 180);
  for (std::size_t k = 0; k < count; ++k) {
    if (ids[k] == 0) continue;
    const SightRay& ray = rays[k * stride];
    const Plane& plane = planes_[ids[k] - 1];
    const double cosine = -plane.normal.dot(rotation * ray.direction);
    const double beyond = world_from_scan.scale * ray.range_m - static_cast<double>(predicted[k]);
    hits[k] = {-beyond * std::abs(cosine), ids[k] - 1, true, cosine > 0,
               plane.normal.dot(rotation * ray.normal) > compatible};
  }
  const auto offsets = face_offsets(rays, hits, options, stride);
  std::vector<SightLine> lines(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto offset = offsets.find(hits[k].face);
    lines[k] = {judge(hits[k], offset == offsets.end() ? 0 : offset->second, options), hits[k].face};
  }
  return lines;
}

SightShares shares_of(const std::vector<SightRay>& rays, const std::vector<SightLine>& lines,
                      std::size_t stride) {
  SightShares shares;
  double total = 0;
  std::map<std::uint32_t, double> costs;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double area = rays[k * stride].area_m2;
    total += area;
    switch (lines[k].sight) {
      case Sight::supported:
        shares.supported += area;
        break;
      case Sight::near:
        break;
      case Sight::in_front:
        shares.in_front += area;
        break;
      case Sight::nothing:
        shares.nothing += area;
        break;
      case Sight::through:
        shares.through += area;
        costs[lines[k].face] += area;
        break;
      case Sight::behind:
        shares.behind += area;
        costs[lines[k].face] += area;
        break;
    }
  }
  if (!(total > 0)) return shares;
  double cost = 0;
  for (const auto& [face, area] : costs) cost += std::min(area, kMostPerFace * total);
  for (double* share :
       {&shares.supported, &shares.in_front, &shares.through, &shares.behind, &shares.nothing})
    *share /= total;
  shares.score = shares.supported + kInFront * (shares.in_front + shares.nothing) + kThrough * cost / total;
  return shares;
}

}  // namespace hybrid::stages
