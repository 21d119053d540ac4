#include "stages/planes/strip_planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kStripShare = 0.7;        // of the strip: free samples
constexpr double kMostStripScatter = 1.5;  // times the noise
constexpr double kUneven_m = 0.001;        // beyond it

SquareRecord fit(const std::vector<Vec3>& points, const RangeNoise& noise) {
  SquareRecord record{};
  record.state = SQUARE_NON_PLANAR;
  record.valid = record.inliers = static_cast<HYBRID_UINT>(points.size());
  const auto count = static_cast<double>(points.size());
  // About the first one, so that nothing cancels.
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero(), products = Vec3::Zero();
  for (const Vec3& point : points) {
    const Vec3 arm = point - points[0];
    sum += arm;
    squares += arm.cwiseProduct(arm);
    products += Vec3(arm.x() * arm.y(), arm.x() * arm.z(), arm.y() * arm.z());
  }
  const Vec3 mean = points[0] + sum / count;
  Mat3 scatter;
  scatter << squares.x(), products.x(), products.y(),  //
      products.x(), squares.y(), products.z(),         //
      products.y(), products.z(), squares.z();
  scatter -= sum * sum.transpose() / count;
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(scatter);
  Vec3 normal = eigen.eigenvectors().col(0);
  if (normal.dot(mean) > 0) normal = -normal;
  const double range = mean.norm(), cosine = std::abs(normal.dot(mean)) / std::max(range, 1e-9);
  const double sigma = noise.at(range, cosine) * cosine;
  const double rms = std::sqrt(std::max(eigen.eigenvalues()[0], 0.0) / count);
  if (!normal.allFinite() || rms > kMostStripScatter * sigma + kUneven_m || !(eigen.eigenvalues()[1] > 0))
    return record;
  record.state = SQUARE_PLANAR;
  record.rms = static_cast<float>(rms);
  record.offset = static_cast<float>(normal.dot(mean));
  record.sigma_normal = static_cast<float>(std::max(sigma, rms) / std::sqrt(eigen.eigenvalues()[1]));
  for (int k = 0; k < 3; ++k) {
    record.normal[k] = static_cast<float>(normal[k]);
    record.centroid[k] = static_cast<float>(mean[k]);
  }
  return record;
}

}  // namespace

SquarePlanes fit_strips(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                        const SquarePlanes& squares, int height, int width) {
  SquarePlanes strips;
  strips.square = std::max(height, width);
  strips.rows = (image.rows + height - 1) / height;
  strips.cols = (image.cols + width - 1) / width;
  strips.sigma_m = squares.sigma_m;
  strips.noise = squares.noise;
  strips.squares.resize(static_cast<std::size_t>(strips.rows) * static_cast<std::size_t>(strips.cols));
  const double least = std::max(3.0, kStripShare * height * width);
  const auto is_free = [&](std::size_t i) { return labels[i] == 0 && image.mask[i] == kMeasured; };
  parallel_for(static_cast<std::size_t>(strips.rows), [&](std::size_t r) {
    const int top = static_cast<int>(r) * height, bottom = std::min(top + height, image.rows);
    // Most strips have few free samples: row by row they are counted before any is taken.
    std::vector<int> free(static_cast<std::size_t>(strips.cols));
    for (int row = top; row < bottom; ++row)
      for (int c = 0; c < strips.cols; ++c)
        for (int col = c * width; col < std::min((c + 1) * width, image.cols); ++col)
          free[static_cast<std::size_t>(c)] += is_free(image.index(row, col)) ? 1 : 0;
    std::vector<Vec3> points;
    for (int c = 0; c < strips.cols; ++c) {
      if (free[static_cast<std::size_t>(c)] < least) continue;
      points.clear();
      for (int row = top; row < bottom; ++row)
        for (int col = c * width; col < std::min((c + 1) * width, image.cols); ++col)
          if (const std::size_t i = image.index(row, col); is_free(i)) points.push_back(image.point(i));
      strips.squares[r * static_cast<std::size_t>(strips.cols) + static_cast<std::size_t>(c)] =
          fit(points, squares.noise);
    }
  });
  return strips;
}

}  // namespace hybrid::stages
