#include "stages/registration/sight_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "core/disjoint_sets.hpp"
#include "core/parallel.hpp"
#include "shared/params_ray_cast.h"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::stages {

struct SightCaster::Hit {
  double height = 0;  // of the sample over the face, towards the scanner positive
  std::uint32_t face = 0;
  bool any = false, front = false, compatible = false;
};

namespace {

constexpr std::size_t kRaysAtATime = 1 << 18;  // by one launch, or those of one pose
constexpr double kSmallFace = 0.05;            // of the model's area: larger ones are walls
constexpr double kStrayShare = 0.1;  // of what a face supports: less beside its neighbours are a few at edges

// What a sample counts that no face supports, and how much of all area one face can cost: openings exist.
constexpr double kInFront = -0.1, kThrough = -0.5, kMostPerFace = 0.3;

// Small faces that share edges, numbered from 1 by group; 0 for all others.
std::vector<std::uint32_t> recesses(const PolygonModel& model) {
  double total = 0;
  std::vector<double> area;
  for (const Face& face : model.faces) total += area.emplace_back(face_area_m2(model, face));
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> on_edge;
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    if (area[f] >= kSmallFace * total) continue;
    const auto& ring = model.faces[f].outer;
    for (std::size_t k = 0; k < ring.size(); ++k)
      on_edge[std::minmax(ring[k], ring[(k + 1) % ring.size()])].push_back(f);
  }
  DisjointSets sets(model.faces.size());
  for (const auto& [edge, faces] : on_edge)
    for (const std::uint32_t f : faces) sets.join(f, faces[0]);
  std::vector<std::uint32_t> size(model.faces.size()), group(model.faces.size());
  for (std::uint32_t f = 0; f < group.size(); ++f) ++size[sets.of(f)];
  for (std::uint32_t f = 0; f < group.size(); ++f)
    if (size[sets.of(f)] > 1) group[f] = sets.of(f) + 1;
  return group;
}

// Area-weighted median of the heights near each face, within the options' offset.
template <typename Hit>
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

template <typename Hit>
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
  recess_ = recesses(model.polygons());
}

void SightCaster::doubt_recesses(const std::vector<SightRay>& rays, std::size_t stride,
                                 const std::vector<Hit>& hits, const SightOptions& options,
                                 std::vector<SightLine>& lines) const {
  struct Fit {
    double on = 0, off = 0;  // area that lies on faces, and that shows them to be elsewhere
    double moment = 0;       // of what is on them: area times height
  };
  std::map<std::uint32_t, Fit> of_face, of_recess;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].sight == Sight::nothing || recess_[lines[k].face] == 0) continue;
    Fit& fit = of_face[lines[k].face];
    const double area = rays[k * stride].area_m2;
    if (lines[k].sight == Sight::supported) {
      fit.on += area;
      fit.moment += area * hits[k].height;
    } else if (lines[k].sight != Sight::in_front) {  // furniture may stand in a niche
      fit.off += area;
    }
  }
  std::set<std::uint32_t> elsewhere;
  for (auto& [face, fit] : of_face)
    if (std::abs(fit.moment) > options.recess_m * fit.on) {
      elsewhere.insert(face);
      fit = {0, fit.on + fit.off, 0};
    }
  for (const auto& [face, fit] : of_face) {
    of_recess[recess_[face]].on += fit.on;
    of_recess[recess_[face]].off += fit.off;
  }
  for (SightLine& line : lines) {
    if (line.sight != Sight::supported || recess_[line.face] == 0) continue;
    const Fit &own = of_face[line.face], &all = of_recess[recess_[line.face]];
    const double off = all.off - own.off, on = all.on - own.on;
    if (elsewhere.contains(line.face) || (off > on && off > kStrayShare * own.on)) line.sight = Sight::near;
  }
}

// Of each pose a whole number of the device's packets.
SightCaster::Seen SightCaster::trace(const std::vector<SightRay>& rays, std::span<const Pose> poses,
                                     std::size_t stride) {
  constexpr std::size_t kWidest = 16;
  const std::size_t count = (rays.size() + stride - 1) / stride,
                    padded = (count + kWidest - 1) / kWidest * kWidest, all = padded * poses.size();
  std::vector<float> directions(3 * (all + poses.size()), std::numeric_limits<float>::quiet_NaN());
  parallel_for(poses.size(), [&](std::size_t p) {
    const Mat3 rotation = poses[p].rotation.toRotationMatrix();
    for (std::size_t k = 0; k < count; ++k)
      store(rotation * rays[k * stride].direction, &directions[3 * (p * padded + k)]);
    store(poses[p].translation - origin_, &directions[3 * (all + p)]);
  });
  RayCastParams params{};
  params.cols = static_cast<std::uint32_t>(all);
  params.rows = 1;
  params.root = bvh_.root;
  params.rays_per_origin = static_cast<std::uint32_t>(padded);
  auto distance = queue_.array<float>(all);
  auto id = queue_.array<std::uint32_t>(all);
  const auto no_surface = queue_.array<float>(0);
  queue_.launch("ray_cast", queue_.kernel("ray_cast", {{"VW", queue_.vector_width()}}),
                packet_grid(queue_.vector_width(), all, 1), params, bvh_.nodes, bvh_.triangles, bvh_.spheres,
                bvh_.surfaces, queue_.array(directions), distance, id, no_surface);
  return {padded, queue_.read(distance), queue_.read(id)};
}

std::vector<SightLine> SightCaster::judge_all(const std::vector<SightRay>& rays, const Pose& world_from_scan,
                                              const SightOptions& options, std::size_t stride,
                                              const Seen& seen, std::size_t pose) const {
  const Mat3 rotation = world_from_scan.rotation.toRotationMatrix();
  std::vector<Hit> hits((rays.size() + stride - 1) / stride);
  const double compatible = std::cos(options.normal_deg * std::numbers::pi / 180);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const std::size_t at = pose * seen.rays_of_each + k;
    if (seen.id[at] == 0) continue;
    const SightRay& ray = rays[k * stride];
    const Plane& plane = planes_[seen.id[at] - 1];
    const double cosine = -plane.normal.dot(rotation * ray.direction);
    const double beyond = world_from_scan.scale * ray.range_m - static_cast<double>(seen.distance_m[at]);
    hits[k] = {-beyond * std::abs(cosine), seen.id[at] - 1, true, cosine > 0,
               plane.normal.dot(rotation * ray.normal) > compatible};
  }
  const auto offsets = face_offsets(rays, hits, options, stride);
  std::vector<SightLine> lines(hits.size());
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const auto offset = offsets.find(hits[k].face);
    lines[k] = {judge(hits[k], offset == offsets.end() ? 0 : offset->second, options), hits[k].face,
                recess_[hits[k].face] != 0};
  }
  if (options.recesses) doubt_recesses(rays, stride, hits, options, lines);
  return lines;
}

std::vector<SightLine> SightCaster::cast(const std::vector<SightRay>& rays, const Pose& world_from_scan,
                                         const SightOptions& options, std::size_t stride) {
  return cast(rays, std::vector<Pose>{world_from_scan}, options, stride).front();
}

std::vector<std::vector<SightLine>> SightCaster::cast(const std::vector<SightRay>& rays,
                                                      const std::vector<Pose>& poses,
                                                      const SightOptions& options, std::size_t stride) {
  std::vector<std::vector<SightLine>> lines(poses.size());
  if (rays.empty()) return lines;
  const std::size_t at_a_time = std::max<std::size_t>(kRaysAtATime * stride / rays.size(), 1);
  for (std::size_t first = 0; first < poses.size(); first += at_a_time) {
    const auto some = std::span(poses).subspan(first, std::min(at_a_time, poses.size() - first));
    const Seen seen = trace(rays, some, stride);
    parallel_for(some.size(), [&](std::size_t p) {
      lines[first + p] = judge_all(rays, some[p], options, stride, seen, p);
    });
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
