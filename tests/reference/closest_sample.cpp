#include "cases/closest_sample_case.hpp"

#include <algorithm>
#include <limits>

namespace hybrid::testing {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kTurn = 2 * std::numbers::pi;

double angle_between(double a, double b) {
  return std::abs(std::remainder(a - b, kTurn));
}

// Index of the nearest angle; whether another is as near to within rounding.
std::size_t nearest(const std::vector<double>& angles, double angle, bool& doubtful) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (angle_between(angles[i], angle) < angle_between(angles[best], angle)) best = i;
  for (std::size_t i = 0; i < angles.size(); ++i)
    doubtful |= i != best && angle_between(angles[i], angle) - angle_between(angles[best], angle) < 1e-5;
  return best;
}

// By how many steps a direction lies beyond the rows or columns, whichever is more.
double steps_outside(const ClosestSampleCase::Input& in, double el, double az) {
  const auto past = [](double by, double a, double b) { return by > 0 ? by / std::abs(a - b) : 0.0; };
  const auto& e = in.elevation;
  const auto& a = in.azimuth;
  const double rows =
      std::max(past(el - e.front(), e[0], e[1]), past(e.back() - el, e[e.size() - 2], e.back()));
  const double middle = (a.front() + a.back()) / 2, off = std::remainder(az - middle, kTurn);
  if (in.wraps) return rows;
  return std::max({rows, past(middle + off - a.back(), a[a.size() - 2], a.back()),
                   past(a.front() - middle - off, a[0], a[1])});
}
constexpr double kMostSteps = 1.5;  // a node's own half and one more

}  // namespace

// Every node whose ray passes within the gate is tried.
ClosestSampleCase::Output ClosestSampleCase::reference(const Input& in) {
  Output out;
  const double facing = std::cos(in.normal_deg * std::numbers::pi / 180);
  const auto rows = static_cast<int>(in.elevation.size()), cols = static_cast<int>(in.azimuth.size());
  for (std::size_t i = 0; i < in.x.size(); ++i) {
    const Vec3 p = in.grid_from_scan * Vec3(in.x[i], in.y[i], in.z[i]),
               n = in.grid_from_scan.rotate(Vec3(in.nx[i], in.ny[i], in.nz[i]));
    double best = kNone, second = kNone, height = kNone, clearance = kNone;
    Vec3 normal = Vec3::Constant(kNone);
    bool doubtful = false;
    const double el = std::atan2(p.z(), std::hypot(p.x(), p.y())), az = std::atan2(p.y(), p.x());
    const double steps = steps_outside(in, el, az);
    const bool inside = !p.hasNaN() && steps < kMostSteps;
    doubtful |= std::abs(steps - kMostSteps) < 0.2;
    bool strided = false;
    if (inside) {
      const double gate = static_cast<double>(in.gate) + static_cast<double>(in.reach) * p.norm();
      const auto visit = [&](int row, int col, const auto& body) {
        if (row < 0 || row >= rows) return;
        if (!in.wraps && (col < 0 || col >= cols)) return;
        const auto k = static_cast<std::size_t>(row * cols + (col + cols) % cols);
        body(Vec3(in.px[k], in.py[k], in.pz[k]), Vec3(in.qx[k], in.qy[k], in.qz[k]));
      };
      const auto row = static_cast<int>(nearest(in.elevation, el, doubtful)),
                 col = static_cast<int>(nearest(in.azimuth, az, doubtful));
      for (int r = row - 1; r <= row + 1; ++r)
        for (int c = col - 1; c <= col + 1; ++c)
          visit(r, c,
                [&](const Vec3& q, const Vec3&) { clearance = std::fmin(clearance, q.norm() - p.norm()); });
      const double wide_el = std::asin(std::min(gate / p.norm(), 1.0)),
                   wide_az = std::asin(std::min(gate / p.head<2>().norm(), 1.0));
      const double row_step = (in.elevation.front() - in.elevation.back()) / (rows - 1),
                   col_step = (in.azimuth.back() - in.azimuth.front()) / (cols - 1);
      strided = gate / p.norm() > CLOSEST_SAMPLE_WINDOW * row_step * 0.99 ||
                gate / p.head<2>().norm() > CLOSEST_SAMPLE_WINDOW * col_step * 0.99;
      for (int r = 0; r < rows; ++r) {
        if (std::abs(in.elevation[static_cast<std::size_t>(r)] - el) > wide_el) continue;
        for (int c = 0; c < cols; ++c) {
          if (angle_between(in.azimuth[static_cast<std::size_t>(c)], az) > wide_az) continue;
          visit(r, c, [&](const Vec3& q, const Vec3& towards) {
            const double distance = (p - q).norm();
            if (!(distance < gate + kTolerance_m)) return;
            const double cosine = towards.dot(n);
            if (!(cosine > facing - 1e-5)) return;
            doubtful |= std::abs(distance - gate) < kTolerance_m || cosine < facing + 1e-5;
            if (distance >= best) {
              second = std::fmin(second, distance);
              return;
            }
            second = best;
            best = distance;
            normal = towards;
            height = towards.dot(p - q);
          });
        }
      }
      doubtful |= second - best < kTolerance_m;
    }
    const auto add = [](std::vector<float>& to, double value) { to.push_back(static_cast<float>(value)); };
    add(out.distance, best), add(out.height, height), add(out.clearance, clearance);
    add(out.normal_x, normal.x()), add(out.normal_y, normal.y()), add(out.normal_z, normal.z());
    out.doubtful.push_back(doubtful);
    out.strided.push_back(strided);
  }
  return out;
}

}  // namespace hybrid::testing
