#include "stages/registration/joint_pairs.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "stages/registration/tile_icp.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSameNormalDeg = 4;
constexpr double kBesideContour_m = 0.3;  // a tile of 2 m may reach over the other scan's contour

double median_by_area(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0, sum = 0;
  for (const auto& [value, area] : values) total += area;
  for (const auto& [value, area] : values)
    if ((sum += area) >= total / 2) return value;
  return 0;
}

}  // namespace

std::vector<JointMatch> find_matches(const std::vector<JointScan>& scans, const std::vector<Pose>& poses,
                                     double reach_m) {
  const double along = std::cos(kSameNormalDeg * std::numbers::pi / 180);
  std::vector<JointMatch> matches;
  for (std::size_t from = 0; from < scans.size(); ++from)
    for (std::size_t to = 0; to < scans.size(); ++to) {
      if (from == to) continue;
      const Pose to_from = poses[to].inverse() * poses[from];
      const ScanEvidence& evidence = *scans[from].evidence;
      const auto pairs =
          find_tile_pairs(evidence, *scans[to].shapes, to_from, std::max(reach_m, kBesideContour_m));
      for (std::size_t t = 0; t < pairs.size(); ++t) {
        const FaceShape* face = pairs[t].face;
        if (!face || std::abs(pairs[t].height_m) > reach_m ||
            face->outside_m(pairs[t].centroid) > kBesideContour_m ||
            face->plane.normal.dot(to_from.rotate(evidence.tiles[t].normal)) < along)
          continue;
        matches.push_back({from, to, t, face, pairs[t].rms_m, 0});
      }
    }
  return matches;
}

double rms_of(const JointMatch& match, const std::vector<JointScan>& scans, const std::vector<Pose>& poses) {
  const Pose to_from = poses[match.to].inverse() * poses[match.from];
  const PlaneTile& tile = scans[match.from].evidence->tiles[match.tile];
  const Vec3 n = to_from.rotation.conjugate() * match.face->plane.normal;
  const double height = match.face->plane.distance(to_from * tile.centroid);
  return std::sqrt(height * height + std::max(n.dot(tile.scatter * n) / tile.area_m2, 0.0));
}

double median_rms(const std::vector<JointMatch>& matches, const std::vector<JointScan>& scans) {
  std::vector<std::pair<double, double>> values;
  for (const JointMatch& match : matches)
    values.emplace_back(match.rms_m, scans[match.from].evidence->tiles[match.tile].area_m2);
  return median_by_area(std::move(values));
}

std::vector<PairReport> report_pairs(const std::vector<JointScan>& scans, const std::vector<Pose>& poses,
                                     const std::vector<JointMatch>& matches) {
  struct Sums {
    double area[2] = {0, 0}, square = 0, start_square = 0;
    Mat3 facing = Mat3::Zero();
    std::vector<std::pair<double, double>> distances;
    std::set<std::pair<std::uint32_t, std::uint32_t>> planes;
  };
  std::vector<Pose> starts;
  for (const JointScan& scan : scans) starts.push_back(scan.start);
  std::map<std::pair<std::size_t, std::size_t>, Sums> by_pair;
  for (const JointMatch& match : matches) {
    const bool forward = match.from < match.to;
    Sums& sums = by_pair[std::minmax(match.from, match.to)];
    const PlaneTile& tile = scans[match.from].evidence->tiles[match.tile];
    const double start_rms = rms_of(match, scans, starts);
    const Vec3 n = poses[match.to].rotate(match.face->plane.normal);
    sums.area[forward ? 0 : 1] += tile.area_m2;
    sums.square += tile.area_m2 * match.rms_m * match.rms_m;
    sums.start_square += tile.area_m2 * start_rms * start_rms;
    sums.facing += tile.area_m2 * n * n.transpose();
    sums.distances.emplace_back(match.rms_m, tile.area_m2);
    sums.planes.insert(forward ? std::pair{tile.supercluster, match.face->face}
                               : std::pair{match.face->face, tile.supercluster});
  }
  std::vector<PairReport> reports;
  for (const auto& [pair, sums] : by_pair) {
    PairReport report;
    report.a = pair.first;
    report.b = pair.second;
    report.area_m2 = sums.area[0] + sums.area[1];
    report.overlap = std::max(sums.area[0] / scans[report.a].evidence->area_m2,
                              sums.area[1] / scans[report.b].evidence->area_m2);
    report.distance_m = std::sqrt(sums.square / report.area_m2);
    report.start_distance_m = std::sqrt(sums.start_square / report.area_m2);
    report.median_m = median_by_area(sums.distances);
    report.strength = 3 * Eigen::SelfAdjointEigenSolver<Mat3>(sums.facing / report.area_m2).eigenvalues()(0);
    report.planes = static_cast<int>(sums.planes.size());
    reports.push_back(report);
  }
  return reports;
}

}  // namespace hybrid::stages
