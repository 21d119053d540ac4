#include "stages/registration/automatic_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/error.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::stages {
namespace {

constexpr int kTileSamples = 100000;  // a tile of 2 m keeps hundreds of samples in the largest buildings
constexpr double kTileSide_m = 2;
// Pieces of one plane: normals within 2 degrees, and the smaller one's centroid this near the other's plane.
constexpr double kSameNormal = 0.99939, kSameOffset_m = 0.03;

// Two planes face each other, or stand across, within 10 degrees; and a plane reaches another where this many
// samples are this near to it, or this many of their spacings.
constexpr double kFacing = 0.985, kAcross = 0.174, kReach_m = 0.1, kReachSpacings = 2.5;
constexpr int kReaching = 3;

// Scan plane of every supercluster.
std::vector<std::uint32_t> merge_planes(const std::vector<Supercluster>& superclusters,
                                        std::vector<ScanPlane>& planes) {
  std::vector<std::size_t> order(superclusters.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return superclusters[a].area_m2 > superclusters[b].area_m2;
  });
  std::vector<std::uint32_t> plane_of(superclusters.size());
  for (const std::size_t s : order) {
    const Supercluster& one = superclusters[s];
    std::size_t k = 0;
    while (k < planes.size() && !(planes[k].plane.normal.dot(one.plane.normal) > kSameNormal &&
                                  std::abs(planes[k].plane.distance(one.centroid_m)) < kSameOffset_m))
      ++k;
    if (k == planes.size()) planes.push_back({one.plane, one.centroid_m, 0});
    plane_of[s] = static_cast<std::uint32_t>(k);
  }
  return plane_of;
}

Vec3 point_of(const std::array<float, 4>& p) {
  return {p[0], p[1], p[2]};
}

// Two directions in the plane that depend on the normal alone.
std::pair<Vec3, Vec3> in_plane(const Vec3& normal) {
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  const Vec3 u = normal.cross(Vec3::Unit(least)).normalized();
  return {u, normal.cross(u)};
}

void add_tiles(const PlanarSamples& samples, const std::vector<Supercluster>& superclusters,
               const std::vector<std::uint32_t>& plane_of, ScanEvidence& evidence) {
  using Key = std::tuple<std::size_t, long, long>;
  std::map<Key, PlaneTile> tiles;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const std::size_t s = samples.supercluster[i];
    const Vec3 p = point_of(samples.points[i]);
    const auto [u, v] = in_plane(superclusters[s].plane.normal);
    PlaneTile& tile = tiles[{s, std::lround(u.dot(p) / kTileSide_m), std::lround(v.dot(p) / kTileSide_m)}];
    const double area = samples.points[i][3];
    tile.plane = plane_of[s];
    tile.supercluster = static_cast<std::uint32_t>(s);
    tile.normal = superclusters[s].plane.normal;
    tile.area_m2 += area;
    tile.centroid += area * p;
    tile.scatter += area * p * p.transpose();
  }
  for (auto& [key, tile] : tiles) {
    tile.centroid /= tile.area_m2;
    tile.scatter -= tile.area_m2 * tile.centroid * tile.centroid.transpose();
    evidence.tiles.push_back(tile);
  }
}

void add_rays(const PlanarSamples& samples, const std::vector<Supercluster>& superclusters,
              const std::vector<std::uint32_t>& plane_of, ScanEvidence& evidence) {
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const std::size_t s = samples.supercluster[i];
    const Vec3 p = point_of(samples.points[i]);
    const double area = samples.points[i][3];
    evidence.rays.push_back({p.normalized(), p.norm(), superclusters[s].plane.normal, area, plane_of[s]});
    evidence.planes[plane_of[s]].area_m2 += area;
    evidence.area_m2 += area;
    evidence.reach_m += area * p.squaredNorm();
  }
  if (evidence.area_m2 > 0) evidence.reach_m = std::sqrt(evidence.reach_m / evidence.area_m2);
}

// Which planes are of the room itself: the two largest that face each other, floor and ceiling as a rule, and
// those that reach from one of them to the other. Furniture ends below the ceiling, most recesses do so too.
std::vector<bool> spanning(const PlanarSamples& samples, const std::vector<std::uint32_t>& plane_of,
                           const std::vector<ScanPlane>& planes) {
  std::vector<double> area(planes.size());
  double all = 0;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    area[plane_of[samples.supercluster[i]]] += samples.points[i][3];
    all += samples.points[i][3];
  }
  std::array<std::size_t, 2> pair{};
  double largest = 0;
  for (std::size_t a = 0; a < planes.size(); ++a)
    for (std::size_t b = a + 1; b < planes.size(); ++b)
      if (planes[a].plane.normal.dot(planes[b].plane.normal) < -kFacing &&
          std::min(area[a], area[b]) > largest)
        largest = std::min(area[a], area[b]), pair = {a, b};
  std::vector<bool> spans(planes.size());
  if (!(largest > 0)) return spans;
  const double reach_m = std::max(kReach_m, kReachSpacings * std::sqrt(all / samples.points.size()));
  std::vector<std::array<int, 2>> near(planes.size());
  for (std::size_t i = 0; i < samples.points.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      near[plane_of[samples.supercluster[i]]][k] +=
          std::abs(planes[pair[k]].plane.distance(point_of(samples.points[i]))) < reach_m;
  for (std::size_t p = 0; p < planes.size(); ++p)
    spans[p] = std::min(near[p][0], near[p][1]) >= kReaching &&
               std::abs(planes[p].plane.normal.dot(planes[pair[0]].plane.normal)) < kAcross;
  spans[pair[0]] = spans[pair[1]] = true;
  return spans;
}

}  // namespace

ScanEvidence gather_evidence(const RangeImage& image, const PlaneSegmentation& segmentation, int rays,
                             int seed) {
  ScanEvidence evidence;
  const auto plane_of = merge_planes(segmentation.superclusters, evidence.planes);
  const PlanarSamples dense = choose_planar_samples(image, segmentation, kTileSamples, seed);
  const auto spans = spanning(dense, plane_of, evidence.planes);
  add_tiles(dense, segmentation.superclusters, plane_of, evidence);
  add_rays(choose_planar_samples(image, segmentation, rays, seed), segmentation.superclusters, plane_of,
           evidence);
  for (auto& ray : evidence.rays) ray.spans = spans[ray.plane];
  // Planes no ray met (a crop took their samples) are none; the others largest first.
  std::vector<std::uint32_t> order(evidence.planes.size()), rank(evidence.planes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return evidence.planes[a].area_m2 > evidence.planes[b].area_m2;
  });
  std::vector<ScanPlane> sorted;
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    rank[order[k]] = k;
    sorted.push_back(evidence.planes[order[k]]);
    sorted.back().centroid.setZero();
  }
  evidence.planes = std::move(sorted);
  for (auto& ray : evidence.rays) ray.plane = rank[ray.plane];
  std::vector<double> area(evidence.planes.size());
  for (auto& tile : evidence.tiles) {
    tile.plane = rank[tile.plane];
    evidence.planes[tile.plane].centroid += tile.area_m2 * tile.centroid;
    area[tile.plane] += tile.area_m2;
  }
  for (std::size_t k = 0; k < area.size(); ++k)
    if (area[k] > 0) evidence.planes[k].centroid /= area[k];
  while (!evidence.planes.empty() && !(evidence.planes.back().area_m2 > 0)) evidence.planes.pop_back();
  std::erase_if(evidence.tiles, [&](const PlaneTile& t) { return t.plane >= evidence.planes.size(); });
  return evidence;
}

ScanEvidence turned(const ScanEvidence& evidence, const Eigen::Quaterniond& q) {
  ScanEvidence out = evidence;
  const Mat3 r = q.toRotationMatrix();
  for (auto& plane : out.planes) {
    plane.plane.normal = r * plane.plane.normal;
    plane.centroid = r * plane.centroid;
  }
  for (auto& tile : out.tiles) {
    tile.normal = r * tile.normal;
    tile.centroid = r * tile.centroid;
    tile.scatter = r * tile.scatter * r.transpose();
  }
  for (auto& ray : out.rays) {
    ray.direction = r * ray.direction;
    ray.normal = r * ray.normal;
  }
  return out;
}

}  // namespace hybrid::stages
