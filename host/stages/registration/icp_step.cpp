#include "stages/registration/icp_step.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "stages/registration/automatic_words.hpp"
#include "stages/registration/landmarks.hpp"

namespace hybrid::stages {
namespace {

using MatrixX = Eigen::MatrixXd;
using VectorX = Eigen::VectorXd;
using Solver = Eigen::SelfAdjointEigenSolver<MatrixX>;

constexpr double kMaxRotationRad = 0.35;
constexpr double kOpenVariance = 1e6;  // along degenerate directions, rad^2 or m^2

// Unknowns in metres at the samples' rms distance: rotation and scale times the radius.
VectorX units(double radius_m, bool free_scale) {
  VectorX unit(free_scale ? 7 : 6);
  unit.head(6) << 1 / radius_m, 1 / radius_m, 1 / radius_m, 1, 1, 1;
  if (free_scale) unit(6) = 1 / radius_m;
  return unit;
}

// Normal matrix per unit of weight and in these units: eigenvalues are shares, at most about 1.
MatrixX normalised(const PlaneSums& sums, const VectorX& unit) {
  const auto n = unit.size();
  return unit.asDiagonal() * sums.matrix.topLeftCorner(n, n) * unit.asDiagonal() / sums.weight;
}

// Inverse over the determined directions; `open` on the others.
MatrixX inverse_of(const MatrixX& matrix, double open) {
  const Solver solver(matrix);
  VectorX inverse(matrix.rows());
  for (Eigen::Index k = 0; k < inverse.size(); ++k)
    inverse(k) = solver.eigenvalues()(k) >= kDeterminedShare ? 1 / solver.eigenvalues()(k) : open;
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

// A basis of the null space of a 3x3 matrix that people recognise: the axes' projections into it, longest
// first, each with its largest component positive.
std::vector<Vec3> open_directions(const Mat3& matrix) {
  const Solver solver(matrix);
  Mat3 projector = Mat3::Zero();
  int open = 0;
  for (int k = 0; k < 3; ++k) {
    if (solver.eigenvalues()(k) >= kDeterminedShare) continue;
    const Vec3 direction = solver.eigenvectors().col(k);
    projector += direction * direction.transpose();
    ++open;
  }
  std::vector<Vec3> found;
  for (; open > 0; --open) {
    Eigen::Index axis = 0;
    projector.diagonal().maxCoeff(&axis);
    const Vec3 direction = projector.col(axis).normalized();
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    found.push_back(direction(largest) < 0 ? Vec3(-direction) : direction);
    projector -= direction * direction.transpose();
  }
  return found;
}

// A rotation vector about `pivot`, a translation and a change of scale.
StepSize move(const Vec3& pivot, const Vec3& rotation, const Vec3& translation, double relative_scale,
              Pose& pose) {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (rotation.norm() > 0) turn = Eigen::AngleAxisd(rotation.norm(), rotation.normalized());
  const double factor = std::exp(relative_scale);
  pose.translation = pivot + factor * (turn * (pose.translation - pivot)) + translation;
  pose.rotation = (turn * pose.rotation).normalized();
  pose.scale *= factor;
  return {rotation.norm(), translation.norm(), std::abs(relative_scale)};
}

}  // namespace

StepSize apply_plane_step(const PlaneSums& sums, const Vec3& pivot, double radius_m, bool free_scale,
                          Pose& pose) {
  const VectorX unit = units(radius_m, free_scale);
  const VectorX right = unit.asDiagonal() * sums.right.head(unit.size()) / sums.weight;
  VectorX step = -(unit.asDiagonal() * inverse_of(normalised(sums, unit), 0) * right);
  const double angle = step.head<3>().norm();
  if (angle > kMaxRotationRad) step *= kMaxRotationRad / angle;
  return move(pivot, step.head<3>(), step.segment<3>(3), free_scale ? step(6) : 0, pose);
}

StepSize return_along_open(const PlaneSums& sums, const Vec3& centre_in_scan, double radius_m,
                           const Pose& start, Pose& pose) {
  const VectorX unit = units(radius_m, false);
  const Solver solver(normalised(sums, unit));
  const Vec3 pivot = pose * centre_in_scan;
  const Eigen::AngleAxisd turned(pose.rotation * start.rotation.conjugate());
  VectorX moved(6);
  moved << turned.angle() * turned.axis(), pivot - start * centre_in_scan;
  moved = moved.cwiseQuotient(unit);
  VectorX back = VectorX::Zero(6);
  for (Eigen::Index k = 0; k < 6; ++k)
    if (solver.eigenvalues()(k) < kDeterminedShare) {
      const VectorX direction = solver.eigenvectors().col(k);
      back -= direction.dot(moved) * direction;
    }
  back = back.cwiseProduct(unit);
  return move(pivot, back.head<3>(), back.tail<3>(), 0, pose);
}

double least_share(const PlaneSums& sums, double radius_m) {
  return Solver(normalised(sums, units(radius_m, false))).eigenvalues()(0);
}

Pose horn_pose(const PointSums& sums, double scale, bool free_scale) {
  Pose pose;
  pose.rotation = horn_rotation(sums.cross);
  // sum r'.R l' = trace(R sum l' r'^T)
  const double along = (pose.rotation.toRotationMatrix() * sums.cross).trace();
  pose.scale = free_scale && sums.scan_square > 0 ? along / sums.scan_square : scale;
  pose.translation = sums.centroid_world - pose.scale * (pose.rotation * sums.centroid_scan);
  return pose;
}

std::vector<std::string> OpenDirections::in_words() const {
  std::vector<std::string> words;
  for (const Vec3& direction : slides) words.push_back("free to slide along " + vector_in_words(direction));
  for (const Vec3& axis : turns) words.push_back("free to turn about " + vector_in_words(axis));
  if (scale) words.emplace_back(kFreeToScale);
  return words;
}

std::optional<Vec3> OpenDirections::only_slide() const {
  if (slides.size() != 1 || !turns.empty() || scale) return std::nullopt;
  return slides.front();
}

OpenDirections degenerate_directions(const PlaneSums& sums, double radius_m, bool free_scale) {
  const MatrixX h = normalised(sums, units(radius_m, free_scale));
  const Mat3 slide = h.block<3, 3>(3, 3), both = h.block<3, 3>(0, 3);
  // What resists a turn when the translation gives way as it likes: the Schur complement.
  const Mat3 turn = h.block<3, 3>(0, 0) - both * inverse_of(slide, 0) * both.transpose();
  OpenDirections open{open_directions(slide), open_directions(turn)};
  if (free_scale) {
    const MatrixX coupling = h.topRightCorner(6, 1);
    const double rest =
        h(6, 6) - (coupling.transpose() * inverse_of(h.topLeftCorner(6, 6), 0) * coupling)(0, 0);
    open.scale = rest < kDeterminedShare;
  }
  return open;
}

std::array<double, 36> pose_covariance(const PlaneSums& sums, double variance, const Vec3& pivot,
                                       double radius_m, bool free_scale) {
  const VectorX unit = units(radius_m, free_scale);
  const MatrixX at_pivot = unit.asDiagonal() *
                           (variance * inverse_of(normalised(sums, unit), kOpenVariance / variance)) *
                           unit.asDiagonal();
  // x -> pivot + (1 + s)(x - pivot) + w x (x - pivot) + t, written about the world's origin.
  MatrixX about_origin = MatrixX::Identity(6, unit.size());
  about_origin.block<3, 3>(3, 0) << 0, -pivot.z(), pivot.y(), pivot.z(), 0, -pivot.x(), -pivot.y(), pivot.x(),
      0;
  if (free_scale) about_origin.block<3, 1>(3, 6) = -pivot;
  const MatrixX covariance = about_origin * at_pivot * about_origin.transpose();
  std::array<double, 36> out{};
  for (int k = 0; k < 36; ++k)
    out[static_cast<std::size_t>(k)] = (covariance(k / 6, k % 6) + covariance(k % 6, k / 6)) / 2;
  return out;
}

}  // namespace hybrid::stages
