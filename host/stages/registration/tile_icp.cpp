#include "stages/registration/tile_icp.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stages/registration/icp_step.hpp"

namespace hybrid::stages {
namespace {

constexpr double kCompatible = 0.7071;  // cosine: 45 degrees
// Faces of a proxy are off by centimetres: a finer scale would lock onto floor and ceiling and drop the
// walls.
constexpr double kScaleFloor_m = 0.015, kScaleStart_m = 0.15;
constexpr double kTileReach_m = 1.5;  // a tile with no face this near has none

Mat3 cross_matrix(const Vec3& n) {
  Mat3 m;
  m << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
  return m;
}

double median_rms(const ScanEvidence& scan, const std::vector<TilePair>& pairs) {
  std::vector<std::pair<double, double>> sorted;
  double total = 0;
  for (std::size_t t = 0; t < pairs.size(); ++t)
    if (pairs[t].face) {
      sorted.emplace_back(pairs[t].rms_m, scan.tiles[t].area_m2);
      total += scan.tiles[t].area_m2;
    }
  std::sort(sorted.begin(), sorted.end());
  double sum = 0;
  for (const auto& [rms, area] : sorted)
    if ((sum += area) >= total / 2) return rms;
  return -1;
}

PlaneSums sums_of(const ScanEvidence& scan, const std::vector<TilePair>& pairs, const Pose& pose,
                  const Vec3& pivot, double cutoff) {
  PlaneSums sums;
  for (std::size_t t = 0; t < pairs.size(); ++t) {
    if (!pairs[t].face || !(pairs[t].rms_m < cutoff)) continue;
    const double ratio = pairs[t].rms_m / cutoff, tukey = (1 - ratio * ratio) * (1 - ratio * ratio);
    add_tile(scan.tiles[t], pairs[t], pose, pivot, tukey, sums);
    sums.inlier_area += scan.tiles[t].area_m2;
    sums.inlier_square += scan.tiles[t].area_m2 * pairs[t].rms_m * pairs[t].rms_m;
  }
  return sums;
}

void describe(const PlaneSums& sums, double radius, TileFit& fit) {
  fit.least_share = least_share(sums, radius);
  fit.weakest =
      Eigen::SelfAdjointEigenSolver<Mat3>(Mat3(sums.matrix.block<3, 3>(3, 3))).eigenvectors().col(0);
}

}  // namespace

TilePair pair_of(const PlaneTile& tile, const FaceShape& face, const Pose& pose) {
  TilePair pair;
  pair.face = &face;
  pair.centroid = pose * tile.centroid;
  pair.height_m = face.plane.distance(pair.centroid);
  const Vec3 n = pose.scale * (pose.rotation.conjugate() * face.plane.normal);
  const double thickness2 = n.dot(tile.scatter * n) / tile.area_m2;  // below 0 by rounding
  pair.rms_m = std::sqrt(pair.height_m * pair.height_m + std::max(thickness2, 0.0));
  return pair;
}

std::vector<TilePair> find_tile_pairs(const ScanEvidence& scan, const ModelShapes& model, const Pose& pose,
                                      double reach_m, const std::vector<TilePair>& last) {
  std::vector<TilePair> pairs(scan.tiles.size());
  std::vector<std::uint8_t> near;
  for (std::size_t t = 0; t < scan.tiles.size(); ++t) {
    const PlaneTile& tile = scan.tiles[t];
    pairs[t].centroid = pose * tile.centroid;
    const Vec3 normal = pose.rotate(tile.normal);
    const FaceShape* nearest = nullptr;
    double nearest2 = reach_m * reach_m;
    // The squared distance where it is less than `nearest2`, else that.
    const auto distance2 = [&](const FaceShape& face) {
      const double height = face.plane.distance(pairs[t].centroid);
      if (height * height >= nearest2 || face.plane.normal.dot(normal) < kCompatible) return nearest2;
      const double outside = face.outside_m(pairs[t].centroid, std::sqrt(nearest2 - height * height));
      return std::min(height * height + outside * outside, nearest2);
    };
    if (t < last.size() && last[t].face)  // no farther than that, and of equal ones still the first
      nearest2 = std::nextafter(distance2(*last[t].face), reach_m * reach_m);
    model.face_planes.mark_near(pairs[t].centroid, normal, std::sqrt(nearest2), kCompatible, near);
    for (std::size_t f = 0; f < near.size(); ++f) {
      if (near[f] == 0) continue;
      const FaceShape& face = model.faces[f];
      if (const double found2 = distance2(face); found2 < nearest2) {
        nearest2 = found2;
        nearest = &face;
      }
    }
    if (nearest) pairs[t] = pair_of(tile, *nearest, pose);
  }
  return pairs;
}

void add_tile(const PlaneTile& tile, const TilePair& pair, const Pose& pose, const Vec3& pivot, double factor,
              PlaneSums& sums) {
  const Mat3 linear = pose.scale * pose.rotation.toRotationMatrix();
  const double weight = factor * tile.area_m2;
  const Vec3 n = pair.face->plane.normal, c = pair.centroid - pivot;
  // Moments of the samples about the pivot; height = n . (x - pivot) + h0.
  const Mat3 second = factor * linear * tile.scatter * linear.transpose() + weight * c * c.transpose();
  const double h0 = pair.face->plane.distance(pivot);
  const Mat3 nx = cross_matrix(n);  // x cross n = -nx x
  sums.matrix.block<3, 3>(0, 0) += nx * second * nx.transpose();
  const Vec3 turn = -weight * (nx * c);
  sums.matrix.block<3, 3>(0, 3) += turn * n.transpose();
  sums.matrix.block<3, 3>(3, 0) += n * turn.transpose();
  sums.matrix.block<3, 3>(3, 3) += weight * n * n.transpose();
  sums.right.head<3>() -= nx * (second * n + weight * h0 * c);
  sums.right.segment<3>(3) += weight * (n.dot(c) + h0) * n;
  sums.weight += weight;
}

TileFit fit_tiles(const ScanEvidence& scan, const ModelShapes& model, const Pose& start, int max_iterations) {
  TileFit fit;
  fit.world_from_scan = start;
  Vec3 centre = Vec3::Zero();
  double area = 0;
  for (const PlaneTile& tile : scan.tiles) {
    centre += tile.area_m2 * tile.centroid;
    area += tile.area_m2;
  }
  if (!(area > 0)) return fit;
  centre /= area;
  const double radius = start.scale * std::max(scan.reach_m, 1e-6);
  double scale = kScaleStart_m;
  std::vector<TilePair> pairs;
  for (bool settled = false; !settled && fit.iterations < max_iterations; ++fit.iterations) {
    pairs = find_tile_pairs(scan, model, fit.world_from_scan, kTileReach_m, pairs);
    const double median = median_rms(scan, pairs);
    if (median < 0) return fit;
    const double wanted = std::max(1.4826 * median, kScaleFloor_m), last = scale;
    // As large as at the start where one starts near: a wall may still be off when floor and ceiling are not.
    scale = fit.iterations == 0 ? std::max(wanted, kScaleStart_m) : std::max(wanted, 0.5 * scale);
    const Vec3 pivot = fit.world_from_scan * centre;
    const PlaneSums sums = sums_of(scan, pairs, fit.world_from_scan, pivot, 4.685 * scale);
    if (!(sums.weight > 0)) return fit;
    describe(sums, radius, fit);
    const StepSize step = apply_plane_step(sums, pivot, radius, false, fit.world_from_scan);
    settled = step.angle_rad < 1e-5 && step.distance_m < 5e-5 && fit.iterations > 0 && wanted >= 0.5 * last;
  }
  return fit;
}

}  // namespace hybrid::stages
