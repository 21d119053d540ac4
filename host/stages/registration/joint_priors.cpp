#include "stages/registration/joint_priors.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "stages/registration/icp_step.hpp"
#include "stages/registration/tile_icp.hpp"

namespace hybrid::stages {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kFaceReach_m = 0.1;
// What a supercluster is off its face by is never known better: curvature and strays of its own.
constexpr double kLeastSigma_m = 2e-5, kLeastScale_m = 5e-4;
constexpr double kUnknowns = 6;
constexpr double kOpenSigma_m = 1;  // along directions that nothing holds

struct OnFace {
  PlaneSums sums;
  double square = 0;  // of the tiles' heights, times weight
};

// Supercluster and face.
using Groups = std::map<std::pair<std::uint32_t, std::uint32_t>, OnFace>;

double middle_rms(const ScanEvidence& scan, const std::vector<TilePair>& pairs) {
  std::vector<std::pair<double, double>> values;
  double total = 0, sum = 0;
  for (std::size_t t = 0; t < pairs.size(); ++t)
    if (pairs[t].face) {
      values.emplace_back(pairs[t].rms_m, scan.tiles[t].area_m2);
      total += scan.tiles[t].area_m2;
    }
  std::sort(values.begin(), values.end());
  for (const auto& [value, area] : values)
    if ((sum += area) >= total / 2) return value;
  return 0;
}

Groups group(const ScanEvidence& scan, const ModelShapes& model, const Pose& pose, const Vec3& pivot) {
  const auto pairs = find_tile_pairs(scan, model, pose, kFaceReach_m);
  const double cutoff = 4.685 * std::max(1.4826 * middle_rms(scan, pairs), kLeastScale_m);
  Groups groups;
  for (std::size_t t = 0; t < pairs.size(); ++t) {
    const double ratio = pairs[t].rms_m / cutoff;
    if (!pairs[t].face || ratio >= 1) continue;
    const PlaneTile& tile = scan.tiles[t];
    const double tukey = (1 - ratio * ratio) * (1 - ratio * ratio);
    OnFace& on = groups[{tile.supercluster, pairs[t].face->face}];
    add_tile(tile, pairs[t], pose, pivot, tukey, on.sums);
    on.square += tukey * tile.area_m2 * pairs[t].height_m * pairs[t].height_m;
  }
  return groups;
}

}  // namespace

std::optional<std::array<double, 36>> covariance_on_exact_faces(const ScanEvidence& scan,
                                                                const ModelShapes& model, const Pose& pose) {
  const Vec3 pivot = pose.translation;
  const double radius = pose.scale * std::max(scan.reach_m, 1e-6);
  const Groups groups = group(scan, model, pose, pivot);
  PlaneSums all;
  double square = 0, squared_weights = 0;
  for (const auto& [key, on] : groups) {
    all.matrix += on.sums.matrix;
    all.weight += on.sums.weight;
    square += on.square;
    squared_weights += on.sums.weight * on.sums.weight;
  }
  if (!(all.weight > 0)) return std::nullopt;
  // As many of them say what one is off as there are more than unknowns.
  const double count = static_cast<double>(groups.size());
  const double free = count > kUnknowns ? (count - kUnknowns) / count : 1 / count;
  const double variance = std::max(square / all.weight / free, kLeastSigma_m * kLeastSigma_m);
  const double effective = all.weight * all.weight / squared_weights;
  // In metres at the radius.
  Vector6 unit;
  unit << Vec3::Constant(1 / radius), Vec3::Ones();
  const Matrix6 shares =
      unit.asDiagonal() * all.matrix.topLeftCorner<6, 6>() * unit.asDiagonal() / all.weight;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(shares);
  Vector6 inverse = Vector6::Zero(), spread = Vector6::Constant(kOpenSigma_m * kOpenSigma_m);
  for (int k = 0; k < 6; ++k)
    if (solver.eigenvalues()(k) >= kDeterminedShare) {
      inverse(k) = 1 / solver.eigenvalues()(k);
      spread(k) = std::min(spread(k), variance / effective * inverse(k));
    }
  const Matrix6 axes = unit.asDiagonal() * solver.eigenvectors();
  const Matrix6 bread = axes * inverse.asDiagonal() * axes.transpose() / all.weight;
  Matrix6 filling = Matrix6::Zero();
  for (const auto& [key, on] : groups)
    filling += on.sums.right.head<6>() * on.sums.right.head<6>().transpose();
  const Matrix6 at_scanner =
      axes * spread.asDiagonal() * axes.transpose() + bread * filling * bread.transpose() / free;
  Matrix6 move = Matrix6::Identity();
  move.block<3, 3>(3, 0) << 0, -pivot.z(), pivot.y(), pivot.z(), 0, -pivot.x(), -pivot.y(), pivot.x(), 0;
  std::array<double, 36> covariance{};
  Eigen::Map<Matrix6>(covariance.data()) = move * at_scanner * move.transpose();
  return covariance;
}

std::array<double, 36> covariance_held_along(const std::array<double, 36>& covariance, const Vec3& place,
                                             const Vec3& direction, double sigma_m) {
  const Matrix6 before = Eigen::Map<const Matrix6>(covariance.data());
  Vector6 observed;  // a turn about the world's origin moves the scanner, too
  observed << place.cross(direction), direction;
  const Vector6 gain = before * observed / (sigma_m * sigma_m + observed.dot(before * observed));
  const Matrix6 rest = Matrix6::Identity() - gain * observed.transpose();
  std::array<double, 36> covariance_after{};
  Eigen::Map<Matrix6>(covariance_after.data()) =
      rest * before * rest.transpose() + sigma_m * sigma_m * gain * gain.transpose();
  return covariance_after;
}

}  // namespace hybrid::stages
