#include "stages/scan/noise_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hybrid::stages {
namespace {

constexpr double kFloor_m = 1e-4;
constexpr std::size_t kFewestSquares = 12;  // squares in a bin
constexpr std::size_t kMost = 4096;         // more squares weigh no more: bins compete by what they cover
constexpr std::array kTangents = {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 13.0, 20.0};
constexpr int kRangeBins = 32;  // half octaves from 1/8 m
constexpr double kLeastCosine = 0.05;

struct Scatter {
  double variance_m2 = 0;  // along the rays, of their samples, as their median says
  double range_m = 0, tangent = 0;
};

// Median of chi squared over its freedom (Wilson and Hilferty 1931).
double median_share(double freedom) {
  const double root = 1 - 2 / (9 * freedom);
  return root * root * root;
}

using Bin = std::vector<Scatter>;

std::vector<Bin> sort_squares(const std::vector<SquareRecord>& squares) {
  std::vector<Bin> bins(kRangeBins * kTangents.size());
  for (const SquareRecord& square : squares) {
    if (square.state != SQUARE_PLANAR || square.inliers < 8) continue;
    const double range = std::hypot(square.centroid[0], square.centroid[1], square.centroid[2]);
    const double cosine = std::abs(double{square.offset}) / range;
    if (!(cosine >= kLeastCosine)) continue;
    const double tangent = incidence_tangent(cosine);
    const auto column = std::upper_bound(kTangents.begin(), kTangents.end(), tangent) - kTangents.begin();
    if (column == std::ssize(kTangents)) continue;
    const int row = std::clamp(static_cast<int>(2 * (std::log2(range) + 3)), 0, kRangeBins - 1);
    const double freedom = square.inliers - 3.0;
    const double along = square.rms / cosine;
    const double variance = along * along * square.inliers / freedom / median_share(freedom);
    bins[static_cast<std::size_t>(row) * kTangents.size() + static_cast<std::size_t>(column)].push_back(
        {variance, range, tangent});
  }
  return bins;
}

struct Equation {
  Eigen::Vector4d terms;
  double sigma_m = 0, weight = 0;
};

std::vector<Equation> equations(std::vector<Bin>& bins) {
  std::vector<Equation> result;
  for (Bin& squares : bins) {
    if (squares.size() < kFewestSquares) continue;
    double range = 0, tangent = 0, both = 0;
    const auto count = static_cast<double>(squares.size());
    for (const Scatter& square : squares) {
      range += square.range_m / count;
      tangent += square.tangent / count;
      both += square.range_m * square.tangent / count;
    }
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end(),
                     [](const auto& a, const auto& b) { return a.variance_m2 < b.variance_m2; });
    const double sigma = std::max(kFloor_m, std::sqrt(middle->variance_m2));
    // Relative errors count, so that one far bin does not rule the near ones.
    const double weight = std::sqrt(std::min(count, static_cast<double>(kMost))) / sigma;
    result.push_back({{1, range, tangent, both}, sigma, weight});
  }
  return result;
}

}  // namespace

RangeNoiseRecord RangeNoise::record() const {
  return {static_cast<float>(base_m), static_cast<float>(per_m), static_cast<float>(per_tan_m),
          static_cast<float>(per_m_tan)};
}

RangeNoise fit_range_noise(const std::vector<SquareRecord>& squares, double sigma_m) {
  auto bins = sort_squares(squares);
  const auto rows = equations(bins);
  RangeNoise best{std::max(sigma_m, kFloor_m), 0, 0, 0};
  if (rows.empty()) return best;
  // Non-negative least squares over the 15 sets of terms: the best whose coefficients are positive.
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = 1; set < 16; ++set) {
    std::vector<int> used;
    for (int k = 0; k < 4; ++k)
      if (set >> k & 1u) used.push_back(k);
    if (used.size() > rows.size()) continue;
    Eigen::MatrixXd system(std::ssize(rows), std::ssize(used));
    Eigen::VectorXd right(std::ssize(rows));
    for (Eigen::Index i = 0; i < std::ssize(rows); ++i) {
      const Equation& row = rows[static_cast<std::size_t>(i)];
      for (Eigen::Index k = 0; k < std::ssize(used); ++k)
        system(i, k) = row.weight * row.terms[used[static_cast<std::size_t>(k)]];
      right[i] = row.weight * row.sigma_m;
    }
    const Eigen::VectorXd solved = system.colPivHouseholderQr().solve(right);
    if (!solved.allFinite() || (solved.array() < 0).any()) continue;
    const double error = (right - system * solved).squaredNorm();
    if (error >= least * (1 - 1e-9)) continue;
    least = error;
    std::array<double, 4> terms{};
    for (std::size_t k = 0; k < used.size(); ++k)
      terms[static_cast<std::size_t>(used[k])] = solved[static_cast<Eigen::Index>(k)];
    best = {std::max(terms[0], kFloor_m), terms[1], terms[2], terms[3]};
  }
  return best;
}

}  // namespace hybrid::stages
