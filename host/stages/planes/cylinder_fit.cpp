#include "stages/planes/cylinder_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

#include "stages/planes/cylinder_sums.hpp"

namespace hybrid::stages {
namespace {

constexpr double kLeastTurn = 0.3;  // rad, of the normals about the axis: its variance is kLeastTurn^2 / 12
constexpr double kMostAlong = 0.3;  // of the normals' variance about the axis: how much of it may be along
constexpr std::size_t kFewestOriented = 6;  // oriented points
constexpr std::size_t kFewestFit = 10;      // points
constexpr int kFitRounds = 20;
constexpr double kSettled = 1e-4;  // of the reach: change of the radius and the axis' place

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 a = axis.unitOrthogonal();
  return {a, axis.cross(a)};
}

// Upwards; of a level axis towards +x, else +y.
Vec3 upright(const Vec3& axis) {
  for (const int k : {2, 0, 1})
    if (std::abs(axis[k]) > 1e-9) return axis[k] < 0 ? Vec3(-axis) : axis;
  return axis;
}

// One step; the prior is as strong as points that scatter as these do make it.
CylinderPoints::Sums normal_equations(const CylinderPoints& points, const Cylinder& at,
                                      const std::array<Vec3, 2>& frame, double reach_m) {
  CylinderPoints::Sums sums = points.sums(at, frame, reach_m);
  const double variance = sums.squares / std::max(sums.weight, 1e-300);
  const double prior = variance / (kTaperSigma * kTaperSigma);
  sums.matrix(5, 5) += prior;
  sums.right(5) -= prior * at.taper;
  return sums;
}

// Foot and length: what points within reach take of the axis. The radius stays that of the middle.
void span(const CylinderPoints& points, double reach_m, Cylinder& cylinder) {
  const auto [low, high] = points.extent(cylinder, reach_m);
  if (!(low <= high)) return;
  cylinder.radius_m = cylinder.radius_at(0.5 * (low + high));
  cylinder.foot += low * cylinder.axis;
  cylinder.length_m = high - low;
}

}  // namespace

std::optional<Cylinder> cylinder_through(const std::vector<OrientedPoint>& points) {
  if (points.size() < kFewestOriented) return std::nullopt;
  Mat3 directions = Mat3::Zero();
  for (const auto& [point, normal] : points) directions += normal * normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(directions / static_cast<double>(points.size()));
  const Vec3 spread = eigen.eigenvalues();
  if (spread[1] < kLeastTurn * kLeastTurn / 12 || spread[0] > kMostAlong * spread[1]) return std::nullopt;
  Cylinder found;
  found.axis = upright(eigen.eigenvectors().col(0));
  const auto frame = across(found.axis);
  // point = centre + radius * normal, across the axis: three unknowns, two equations a point.
  Mat3 matrix = Mat3::Zero();
  Vec3 right = Vec3::Zero(), middle = Vec3::Zero();
  for (const auto& [point, normal] : points) middle += point / static_cast<double>(points.size());
  for (const auto& [point, normal] : points)
    for (int k = 0; k < 2; ++k) {
      const auto& direction = frame[static_cast<std::size_t>(k)];
      Vec3 row = Vec3::Zero();
      row[k] = 1;
      row[2] = normal.dot(direction);
      matrix += row * row.transpose();
      right += row * direction.dot(point - middle);
    }
  const Vec3 solved = matrix.ldlt().solve(right);
  if (!solved.allFinite() || solved[2] == 0) return std::nullopt;
  found.foot = middle + solved[0] * frame[0] + solved[1] * frame[1];
  found.radius_m = std::abs(solved[2]);
  found.inside = solved[2] < 0;
  return found;
}

std::optional<Cylinder> fit_cylinder(const std::vector<Vec3>& of, const Cylinder& start, double reach_m) {
  const CylinderPoints points(of);
  Cylinder at = start;
  for (int round = 0; round < kFitRounds; ++round) {
    span(points, reach_m, at);
    const auto frame = across(at.axis);
    const auto sums = normal_equations(points, at, frame, reach_m);
    if (sums.within < kFewestFit) return std::nullopt;
    const Eigen::LDLT<Mat6> solver(sums.matrix);
    const Vec6 step = solver.solve(sums.right);
    if (!step.allFinite()) return std::nullopt;
    const Vec3 middle = at.foot + 0.5 * at.length_m * at.axis + step[0] * frame[0] + step[1] * frame[1];
    const Vec3 leant = (at.axis + step[2] * frame[0] + step[3] * frame[1]).normalized();
    at.axis = upright(leant);
    at.foot = middle - 0.5 * at.length_m * at.axis;
    at.radius_m += step[4];
    at.taper = std::clamp(at.taper + step[5], -0.5, 0.5);
    if (at.axis.dot(leant) < 0) at.taper = -at.taper;
    if (!(at.radius_m > 0)) return std::nullopt;
    if (std::max(step.head<2>().norm() + step.segment<2>(2).norm() * at.length_m, std::abs(step[4])) >
        kSettled * reach_m)
      continue;
    span(points, reach_m, at);
    at.rms_m = std::sqrt(sums.squares / sums.weight);
    at.sigma_radius_m = at.rms_m * std::sqrt(std::max(solver.solve(Vec6::Unit(4))[4], 0.0));
    return at;
  }
  return std::nullopt;
}

}  // namespace hybrid::stages
