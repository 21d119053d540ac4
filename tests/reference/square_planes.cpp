#include <Eigen/Dense>
#include <optional>

#include "cases/square_planes_case.hpp"
#include "lib/random.h"

namespace hybrid::testing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct FittedPlane {
  Vector3d normal;
  double offset;
};

struct Judge {
  const SquarePlanesParams& params;
  std::vector<Vector3d> valid;

  double incidence(const FittedPlane& plane, const Vector3d& p) const {
    return std::max(std::abs(plane.normal.dot(p)) / p.norm(), double{params.min_cosine});
  }
  bool inlier(const FittedPlane& plane, const Vector3d& p) const {
    return std::abs(plane.normal.dot(p) - plane.offset) <= params.threshold_m * incidence(plane, p);
  }
  std::vector<Vector3d> inliers(const FittedPlane& plane) const {
    std::vector<Vector3d> found;
    for (const auto& p : valid)
      if (inlier(plane, p)) found.push_back(p);
    return found;
  }
  bool qualifies(std::size_t count) const {
    return count >= 3 && static_cast<double>(count) >=
                             double{params.min_inlier_share} * static_cast<double>(valid.size()) - 1e-3;
  }
};

Matrix3d scatter(const std::vector<Vector3d>& points, const std::vector<double>& weights, Vector3d& mean) {
  mean.setZero();
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    mean += weights[i] * points[i];
    total += weights[i];
  }
  mean /= total;
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
    sum += weights[i] * (points[i] - mean) * (points[i] - mean).transpose();
  return sum;
}

FittedPlane least_squares(const std::vector<Vector3d>& points, const std::vector<double>& weights) {
  Vector3d mean;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(scatter(points, weights, mean));
  const Vector3d normal = solver.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

// `origin` is the square's first valid sample: msac takes the incidence of the whole square from it.
std::optional<FittedPlane> best_test_plane(const Judge& judge, const std::vector<Vector3d>& square,
                                           const Vector3d& origin, const std::vector<std::uint32_t>& triplets,
                                           std::uint32_t block) {
  std::optional<FittedPlane> best;
  double lowest = INFINITY;
  const std::uint32_t start = random_bits(judge.params.seed, block, 0),
                      stride = random_bits(judge.params.seed, block, 1) | 1u;
  for (std::uint32_t h = 0; h < judge.params.hypotheses; ++h) {
    const std::uint32_t triplet = triplets[(start + h * stride) % triplets.size()];
    const Vector3d a = square[triplet & 255], u = square[triplet >> 8 & 255] - a,
                   v = square[triplet >> 16 & 255] - a, n = u.cross(v);
    if (!(n.squaredNorm() >= 1e-6 * u.squaredNorm() * v.squaredNorm())) continue;
    const FittedPlane plane{n.normalized(), n.normalized().dot(a)};
    const auto inliers = judge.inliers(plane);
    if (!judge.qualifies(inliers.size())) continue;
    double score = 0;
    for (const auto& p : inliers) score += std::abs(plane.normal.dot(p) - plane.offset);
    if (judge.params.score == SQUARE_SCORE_MSAC)
      score = score / judge.incidence(plane, origin) +
              static_cast<double>(judge.valid.size() - inliers.size()) * judge.params.threshold_m;
    if (score < lowest) {
      lowest = score;
      best = plane;
    }
  }
  return best;
}

SquareRecord record(const Judge& judge, const std::optional<FittedPlane>& plane) {
  SquareRecord out{};
  out.valid = static_cast<std::uint32_t>(judge.valid.size());
  if (out.valid < judge.params.min_valid) return out;
  out.state = SQUARE_NON_PLANAR;
  const auto inliers = plane ? judge.inliers(*plane) : std::vector<Vector3d>{};
  if (!judge.qualifies(inliers.size())) return out;
  out.state = SQUARE_PLANAR;
  out.inliers = static_cast<std::uint32_t>(inliers.size());
  const double sign = plane->offset > 0 ? -1 : 1, count = static_cast<double>(inliers.size());
  Vector3d mean;
  const Matrix3d s = scatter(inliers, std::vector<double>(inliers.size(), 1.0), mean);
  double squares = 0;
  for (const auto& p : inliers) squares += std::pow(plane->normal.dot(p) - plane->offset, 2);
  for (int i = 0; i < 3; ++i) {
    out.normal[i] = static_cast<float>(sign * plane->normal[i]);
    out.centroid[i] = static_cast<float>(mean[i]);
  }
  out.offset = static_cast<float>(sign * plane->offset);
  out.rms = static_cast<float>(std::sqrt(squares / count));
  const double entries[6] = {s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
  for (int i = 0; i < 6; ++i) out.scatter[i] = static_cast<float>(entries[i]);
  // In the plane's own axes the scatter is 2 x 2.
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = plane->normal.unitOrthogonal();
  axes.col(1) = plane->normal.cross(axes.col(0));
  const Eigen::Vector2d extent =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(axes.transpose() * s * axes).eigenvalues();
  const double noise = judge.params.sigma_m * judge.incidence(*plane, mean);
  const double variance = std::max(squares / std::max(count - 3, 1.0), noise * noise);
  out.sigma_normal = static_cast<float>(std::sqrt(variance * (1 / extent[0] + 1 / extent[1])));
  return out;
}

}  // namespace

SquarePlanesCase::Output SquarePlanesCase::reference(const Input& input) {
  Output out;
  const std::size_t n = input.side();
  for (std::size_t i = 0; i < input.square_rows() * input.square_cols(); ++i) {
    const std::size_t square_row = i / input.square_cols(), square_col = i % input.square_cols();
    std::vector<Vector3d> square(n * n, Vector3d::Constant(NAN));
    Judge judge{input.params, {}};
    for (std::size_t k = 0; k < n * n; ++k) {
      const std::size_t row = square_row * n + k / n, col = square_col * n + k % n;
      if (row >= input.params.rows || col >= input.params.cols) continue;
      const std::size_t at = row * input.params.cols + col;
      square[k] = {input.x[at], input.y[at], input.z[at]};
      if (!std::isnan(square[k].x())) judge.valid.push_back(square[k]);
    }
    const auto block =
        mix_bits(input.params.first_square_row + static_cast<std::uint32_t>(square_row)) +
        (input.params.first_square_col + static_cast<std::uint32_t>(square_col)) / SQUARE_BLOCK;
    std::optional<FittedPlane> plane;
    if (input.params.fit == SQUARE_FIT_EIGEN && judge.valid.size() >= 3)
      plane = least_squares(judge.valid, std::vector<double>(judge.valid.size(), 1.0));
    else if (input.params.fit == SQUARE_FIT_RANSAC && !judge.valid.empty())
      plane = best_test_plane(judge, square, judge.valid.front(), input.triplets, block);
    if (plane && input.params.fit == SQUARE_FIT_RANSAC) {
      const auto inliers = judge.inliers(*plane);
      std::vector<double> weights;
      for (const auto& p : inliers) weights.push_back(std::pow(judge.incidence(*plane, p), -2));
      const FittedPlane refitted = least_squares(inliers, weights);
      if (judge.qualifies(judge.inliers(refitted).size())) plane = refitted;
    }
    out.push_back(record(judge, plane));
  }
  return out;
}

}  // namespace hybrid::testing
