#include "stages/planes/bending.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "stages/planes/quadratic_sums.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kFewestHeights = 30;
constexpr double kLeastFall = 30;          // fall of chi2 for 3 more parameters
constexpr double kLeastPivot = 1e-3;       // of the largest; samples in two lines fix no quadratic
constexpr double kLeastOfCurvature = 0.5;  // for a part of a plane that bends
constexpr double kAsSharp = 0.5;           // of the curvature with the rim

struct HeightFits {
  double linear = 0, quadratic = 0;  // sums of squared residuals
  double curvature = 0;              // 1/m, the larger principal one
  double spread = 0;                 // of it, for residuals of 1 m
  bool determined = false;
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();  // 1/m, along a and b
};

// height = c0 + c1 a + c2 b + c3 a^2 + c4 a b + c5 b^2 by least squares, and its linear part alone.
HeightFits fit_quadratic(const std::vector<Vec3>& heights) {
  HeightFits fits;
  // Along the samples' own axes, each in units of its own reach: strips are narrow, at any angle.
  const HeightExtent extent = extent_of(heights);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> own(extent.products -
                                                           extent.mean * extent.mean.transpose());
  if (!(own.eigenvalues()[0] > 0)) return fits;
  HeightAxes axes{extent.mean, own.eigenvectors().transpose()};
  axes.scale = reach_of(heights, axes);
  const auto [normal, right, squares] = quadratic_sums(heights, axes);
  const Eigen::Matrix2d& turn = axes.turn;
  const Vec2& scale = axes.scale;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(normal);
  fits.determined = solver.vectorD().minCoeff() > kLeastPivot * solver.vectorD().maxCoeff();
  const Vec6 quadratic = solver.solve(right);
  const Vec3 linear = normal.topLeftCorner<3, 3>().ldlt().solve(right.head<3>());
  fits.linear = squares - linear.dot(right.head<3>());
  fits.quadratic = squares - quadratic.dot(right);
  const double aa = 2 * quadratic[3] / (scale.x() * scale.x()),
               bb = 2 * quadratic[5] / (scale.y() * scale.y());
  const double ab = quadratic[4] / (scale.x() * scale.y());
  const Vec6 narrow = Vec6::Unit(3);  // eigenvalues come in increasing order
  fits.spread = 2 * std::sqrt(narrow.dot(solver.solve(narrow))) / (scale.x() * scale.x());
  fits.hessian = turn.transpose() * (Eigen::Matrix2d() << aa, ab, ab, bb).finished() * turn;
  fits.curvature = 0.5 * (std::abs(aa + bb) + std::hypot(aa - bb, 2 * ab));
  return fits;
}

}  // namespace

Bend bend_of(const std::vector<Vec3>& heights, double min_curvature) {
  Bend bend;
  if (heights.size() < kFewestHeights) return bend;
  const HeightFits fits = fit_quadratic(heights);
  bend.determined = fits.determined;
  bend.curvature = fits.curvature;
  const double variance =
      std::max(fits.quadratic, 1e-12 * fits.linear) / static_cast<double>(heights.size() - 6);
  bend.sigma = fits.spread * std::sqrt(variance);
  const double fall = fits.linear - fits.quadratic;
  if (bend.determined && variance > 0 && fall >= kLeastFall * variance && bend.curvature > min_curvature)
    bend.share = fall / fits.linear;
  return bend;
}

double bends_like(const std::vector<Vec3>& heights, const std::vector<Vec3>& beyond) {
  if (std::min(heights.size(), beyond.size()) < kFewestHeights) return 0;
  const HeightFits as_is = fit_quadratic(heights), wide = fit_quadratic(beyond);
  if (!wide.determined || !(as_is.linear > 0)) return 0;
  std::vector<Vec3> straightened = heights;
  for (Vec3& s : straightened) s.z() -= 0.5 * s.head<2>().dot(wide.hessian * s.head<2>());
  const double variance =
      std::max(as_is.quadratic, 1e-12 * as_is.linear) / static_cast<double>(heights.size() - 6);
  return (as_is.linear - fit_quadratic(straightened).linear) / variance;
}

void PlaneHeights::add(const Vec3& height, const std::array<bool, 4>& neighbours) {
  all.push_back(height);
  for (std::size_t side = 0; side < neighbours.size(); ++side)
    if (neighbours[side]) trimmed[side].push_back(height);
  if (neighbours[0] && neighbours[1] && neighbours[2] && neighbours[3]) inner.push_back(height);
}

Bend PlaneHeights::bend(double min_curvature) const {
  Bend whole = bend_of(all, min_curvature);
  const auto limit_by = [&](const std::vector<Vec3>& part) {
    if (whole.share == 0) return;
    const Bend bend = bend_of(part, kLeastOfCurvature * min_curvature);
    if (bend.determined) whole.share = std::min(whole.share, bend.share);
  };
  limit_by(inner);
  for (const auto& part : trimmed) limit_by(part);
  if (whole.share > 0) {
    const Bend bend = bend_of(core, kLeastOfCurvature * min_curvature);
    const double sharp = kAsSharp * bend_of(inner, 0).curvature;
    if (bend.determined && (bend.share > 0 || bend.curvature < sharp))
      whole.share = std::min(whole.share, bend.share);
  }
  return whole;
}

}  // namespace hybrid::stages
