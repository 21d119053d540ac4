// The baseline any engineer would write: RANSAC per square in plain C++ with OpenMP, no intrinsics, squares
// grown into planes. Same squares, same number of test planes as ours; --variant 8, 16 or 32 test planes.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "shared/grow_squares.hpp"
#include "shared/planes_peer.hpp"

namespace hybrid::peers {
namespace {

struct Points {
  alignas(64) float x[256], y[256], z[256];
  int count = 0;
};

// Cost of a plane: distances cut off at the tolerance (MSAC), and how many points lie within it.
float cost_of(const Points& points, const Eigen::Vector3f& normal, float offset, float tolerance,
              int& inliers) {
  float cost = 0;
  int within = 0;
  for (int i = 0; i < points.count; ++i) {
    const float distance =
        std::abs(normal.x() * points.x[i] + normal.y() * points.y[i] + normal.z() * points.z[i] - offset);
    cost += distance < tolerance ? distance : tolerance;
    within += distance < tolerance;
  }
  inliers = within;
  return cost;
}

// Least squares over the points within the tolerance.
void refit(const Points& points, float tolerance, float offset, SquareFit& fit) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f products = Eigen::Matrix3f::Zero();
  int count = 0;
  const Eigen::Vector3f base(points.x[0], points.y[0], points.z[0]);
  for (int i = 0; i < points.count; ++i) {
    const Eigen::Vector3f p(points.x[i], points.y[i], points.z[i]);
    if (std::abs(fit.normal.dot(p) - offset) >= tolerance) continue;
    const Eigen::Vector3f q = p - base;
    sum += q;
    products += q * q.transpose();
    ++count;
  }
  const Eigen::Vector3f mean = sum / static_cast<float>(count);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(products / static_cast<float>(count) - mean * mean.transpose());
  fit.normal = solver.eigenvectors().col(0).normalized();
  fit.centroid = base + mean;
  if (fit.normal.dot(fit.centroid) > 0) fit.normal = -fit.normal;
}

SquareFit fit_square(const Points& points, int test_planes, float tolerance, int least_inliers,
                     std::minstd_rand& random) {
  SquareFit best;
  float best_cost = INFINITY, best_offset = 0;
  for (int k = 0; k < test_planes; ++k) {
    const auto pick = [&] { return static_cast<int>(random() % static_cast<unsigned>(points.count)); };
    const int a = pick(), b = pick(), c = pick();
    const Eigen::Vector3f p(points.x[a], points.y[a], points.z[a]), q(points.x[b], points.y[b], points.z[b]),
        r(points.x[c], points.y[c], points.z[c]);
    const Eigen::Vector3f cross = (q - p).cross(r - p);
    const float length = cross.norm();
    if (length < 1e-9f) continue;
    const Eigen::Vector3f normal = cross / length;
    const float offset = normal.dot(p);
    int inliers = 0;
    const float cost = cost_of(points, normal, offset, tolerance, inliers);
    if (inliers < least_inliers || cost >= best_cost) continue;
    best_cost = cost;
    best_offset = offset;
    best.normal = normal;
    best.planar = true;
  }
  if (best.planar) refit(points, tolerance, best_offset, best);
  return best;
}

std::vector<SquareFit> fit_squares(const RangeScan& scan, const SquareExtent& extent, int test_planes,
                                   double sigma_m) {
  const float tolerance = static_cast<float>(3 * sigma_m + 0.002);
  std::vector<SquareFit> fits(extent.count());
#pragma omp parallel for schedule(dynamic, 8)
  for (int row = 0; row < extent.rows; ++row) {
    std::minstd_rand random(static_cast<unsigned>(row) + 1);
    std::vector<std::uint32_t> nodes;
    Points points;
    for (int col = 0; col < extent.cols; ++col) {
      square_nodes(scan, extent, row, col, nodes);
      points.count = static_cast<int>(nodes.size());
      if (nodes.size() < 3 || 10 * points.count < 7 * extent.side * extent.side) continue;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        points.x[i] = scan.x[nodes[i]];
        points.y[i] = scan.y[nodes[i]];
        points.z[i] = scan.z[nodes[i]];
      }
      fits[static_cast<std::size_t>(row) * static_cast<std::size_t>(extent.cols) +
           static_cast<std::size_t>(col)] =
          fit_square(points, test_planes, tolerance, (8 * points.count + 9) / 10, random);
    }
  }
  return fits;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  return planes_main(argc, argv, "plain C++ and OpenMP", {"32", "16", "8"},
                     [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
                       const int test_planes = std::stoi(options.variant);
                       const SquareExtent extent(scan, options.square);
                       report.settings = options.variant + " test planes, " + std::to_string(options.square) +
                                         " x " + std::to_string(options.square) + " squares";
                       const Stopwatch watch;
                       const auto fits = fit_squares(scan, extent, test_planes, options.sigma_m);
                       report.parts["squares"] = watch.seconds();
                       if (options.squares_only) return std::vector<std::uint32_t>();
                       return grow_squares(scan, extent, fits, options.sigma_m);
                     });
}
