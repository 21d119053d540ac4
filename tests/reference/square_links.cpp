#include "cases/square_links_case.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace hybrid::testing {
namespace {

using Vec3 = Eigen::Vector3d;

void link(const SquareLinkParams& p, const SquareRecord& a, const SquareRecord& b, bool right, double& cost,
          double& margin) {
  if (a.state != SQUARE_PLANAR || b.state != SQUARE_PLANAR) return;
  const Vec3 na = Eigen::Vector3f(a.normal).cast<double>(), nb = Eigen::Vector3f(b.normal).cast<double>();
  const Vec3 ca = Eigen::Vector3f(a.centroid).cast<double>(), cb = Eigen::Vector3f(b.centroid).cast<double>();
  const double sigma_normal = std::hypot(a.sigma_normal, b.sigma_normal), distance = (cb - ca).norm();
  const double cosine = std::min(std::abs(na.dot(ca.normalized())), std::abs(nb.dot(cb.normalized())));
  const double arm = right ? (ca.head<2>().norm() + cb.head<2>().norm()) / 2 : (ca.norm() + cb.norm()) / 2;
  const double value[3] = {std::atan2(na.cross(nb).norm(), na.dot(nb)), distance,
                           std::max(std::abs((cb - ca).dot(na)), std::abs((cb - ca).dot(nb)))};
  const double limit[3] = {
      std::max<double>(p.angle_rad, p.angle_sigmas * sigma_normal),
      arm * (right ? p.col_reach_rad : p.row_reach_rad) / std::max<double>(cosine, p.min_cosine) +
          p.offset_sigmas * p.sigma_m,
      p.offset_sigmas * std::hypot(p.sigma_m, distance * sigma_normal)};
  bool linked = true;
  for (int k = 0; k < 3; ++k) {
    linked = linked && value[k] < limit[k];
    margin = std::min(margin, std::abs(value[k] / limit[k] - 1));
  }
  if (linked) cost = std::max(value[0] / limit[0], value[2] / limit[2]);
}

}  // namespace

SquareLinksCase::Expected SquareLinksCase::reference(const Input& input) {
  const auto& p = input.params;
  Expected out;
  out.links.assign(2 * input.squares.size(), -1);
  out.margin.assign(2 * input.squares.size(), std::numeric_limits<double>::infinity());
  for (std::uint32_t row = 0; row < p.rows; ++row)
    for (std::uint32_t col = 0; col < p.cols; ++col) {
      const std::size_t i = row * p.cols + col;
      if (col + 1 < p.cols || p.wraps)
        link(p, input.squares[i], input.squares[row * p.cols + (col + 1) % p.cols], true, out.links[2 * i],
             out.margin[2 * i]);
      if (row + 1 < p.rows)
        link(p, input.squares[i], input.squares[i + p.cols], false, out.links[2 * i + 1],
             out.margin[2 * i + 1]);
    }
  return out;
}

}  // namespace hybrid::testing
