#include <Eigen/Dense>

#include "cases/icp_sums_case.hpp"

namespace hybrid::testing {
namespace {

void append(std::vector<double>& terms, const Eigen::MatrixXd& values) {
  for (Eigen::Index row = 0; row < values.rows(); ++row)
    for (Eigen::Index col = 0; col < values.cols(); ++col) terms.push_back(values(row, col));
}

std::vector<double> terms_of(const IcpSumsCase::Input& in, std::size_t i) {
  const Vec3 l = Vec3(in.x[i], in.y[i], in.z[i]) - in.centre_scan;
  const Vec3 r = Vec3(in.near_x[i], in.near_y[i], in.near_z[i]) - in.centre_local;
  const double e = in.error[i], u = e / in.cutoff;
  const bool inlier = std::abs(u) < 1;
  const double weight = inlier ? in.area[i] * (1 - u * u) * (1 - u * u) : 0;
  std::vector<double> terms;
  if (in.point) {
    append(terms, weight * l);
    append(terms, weight * r);
    append(terms, weight * l * r.transpose());
    append(terms, Eigen::Vector2d(weight * l.squaredNorm(), weight * r.squaredNorm()));
  } else {
    const float* normal = in.triangles[in.triangle[i]].normal;
    const Vec3 n =
        in.normals ? Vec3(in.near_x[i], in.near_y[i], in.near_z[i]) : Vec3(normal[0], normal[1], normal[2]);
    const Vec3 p = in.local_from_scan.scale * in.local_from_scan.rotate(l);
    Eigen::Matrix<double, 7, 1> j;
    j << p.cross(n), n, n.dot(p);
    for (int row = 0; row < 7; ++row)
      for (int col = row; col < 7; ++col) terms.push_back(weight * j(row) * j(col));
    append(terms, weight * j * e);
  }
  append(terms, Vec3(weight, inlier ? in.area[i] : 0, inlier ? in.area[i] * e * e : 0));
  return terms;
}

}  // namespace

IcpSumsCase::Output IcpSumsCase::reference(const Input& in) {
  const auto width = static_cast<std::size_t>(in.sums());
  Output out;
  out.partial.assign((in.x.size() + kBlock - 1) / kBlock * width, 0.0);
  out.magnitude = out.partial;
  for (std::size_t i = 0; i < in.x.size(); ++i) {
    if (std::isnan(in.error[i])) continue;
    const auto terms = terms_of(in, i);
    for (std::size_t k = 0; k < width; ++k) {
      out.partial[i / kBlock * width + k] += terms[k];
      out.magnitude[i / kBlock * width + k] += std::abs(terms[k]);
    }
  }
  return out;
}

}  // namespace hybrid::testing
