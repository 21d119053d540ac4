#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "cases/window_planes_case.hpp"

namespace hybrid::testing {
namespace {

// (value - limit) / limit of the tests of one window: it is planar when all are positive or zero.
struct Verdict {
  bool planar = false;
  double margin = std::numeric_limits<double>::infinity();
};

// The plane m . p = 1 through the window's free samples, by least squares of r (1 - m . p).
Verdict judge(const WindowPlanesCase::Input& input, std::size_t row, std::size_t col, int rows, int cols) {
  const auto& params = input.params;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t r = row; r < row + static_cast<std::size_t>(rows); ++r)
    for (std::size_t c = col; c < col + static_cast<std::size_t>(cols); ++c)
      if (const std::size_t i = r * params.halo_cols + c; input.free[i] != 0)
        points.emplace_back(input.x[i], input.y[i], input.z[i]);
  const auto count = static_cast<double>(points.size());
  if (count < static_cast<double>(params.min_share) * rows * cols) return {};
  Eigen::MatrixXd system(points.size(), 3);
  Eigen::VectorXd range(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    range[static_cast<Eigen::Index>(i)] = points[i].norm();
    system.row(static_cast<Eigen::Index>(i)) = points[i].norm() * points[i].transpose();
  }
  const Eigen::Vector3d m = system.colPivHouseholderQr().solve(range);
  const double cosine = m.dot(points[0].normalized()) / m.norm();
  const double tangent = std::min(std::tan(std::acos(std::clamp(cosine, 1e-6, 1.0))), 20.0);
  const double sigma_m = params.noise.base_m + params.noise.per_m * range[0] +
                         (params.noise.per_tan_m + params.noise.per_m_tan * range[0]) * tangent;
  const double chi2 = (range - system * m).squaredNorm() / (sigma_m * sigma_m);
  const double most = count - 3 + params.chi2_sigmas * std::sqrt(2 * (count - 3));
  const double chi2_slack = (most - chi2) / most, cosine_slack = cosine / params.min_cosine - 1;
  return {chi2_slack >= 0 && cosine_slack >= 0, std::min(std::abs(chi2_slack), std::abs(cosine_slack))};
}

}  // namespace

WindowPlanesCase::Expected WindowPlanesCase::reference(const Input& input) {
  const int shapes[WINDOW_SHAPES][2] = {{4, 4}, {8, 3}, {3, 8}, {12, 2}, {2, 12}};
  Expected out;
  for (std::size_t row = 0; row < input.params.rows; ++row)
    for (std::size_t col = 0; col < input.params.cols; ++col) {
      std::uint8_t found = 0;
      double margin = std::numeric_limits<double>::infinity();
      for (std::uint8_t s = 0; s < WINDOW_SHAPES && found == 0; ++s) {
        const bool fits = row + static_cast<std::size_t>(shapes[s][0]) <= input.params.halo_rows &&
                          col + static_cast<std::size_t>(shapes[s][1]) <= input.params.halo_cols;
        if (!fits || input.free[row * input.params.halo_cols + col] == 0) continue;
        const Verdict verdict = judge(input, row, col, shapes[s][0], shapes[s][1]);
        margin = std::min(margin, verdict.margin);
        if (verdict.planar) found = static_cast<std::uint8_t>(s + 1);
      }
      out.shapes.push_back(found);
      out.margin.push_back(margin);
    }
  return out;
}

}  // namespace hybrid::testing
