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

// Index of the nearest angle, or measure of a pinhole; whether another is as near to within rounding.
std::size_t nearest(const std::vector<double>& angles, double angle, bool& doubtful) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (angle_between(angles[i], angle) < angle_between(angles[best], angle)) best = i;
  for (std::size_t i = 0; i < angles.size(); ++i)
    doubtful |= i != best && angle_between(angles[i], angle) - angle_between(angles[best], angle) < 1e-5;
  return best;
}

// By how many steps a direction lies beyond the rows or columns, whichever is more.
double steps_outside(const ClosestSampleCase::Input& in, double row, double col) {
  const auto past = [](double by, double a, double b) { return by > 0 ? by / std::abs(a - b) : 0.0; };
  const auto& e = in.rows;
  const auto& a = in.cols;
  const double rows =
      std::max(past(row - e.front(), e[0], e[1]), past(e.back() - row, e[e.size() - 2], e.back()));
  const double middle = (a.front() + a.back()) / 2, off = std::remainder(col - middle, kTurn);
  if (in.wraps) return rows;
  return std::max({rows, past(middle + off - a.back(), a[a.size() - 2], a.back()),
                   past(a.front() - middle - off, a[0], a[1])});
}
constexpr double kMostSteps = 1.5;  // a node's own half and one more

// The angles of rows or columns, and of the point among them, in its plane through the grid's origin and as
// far off it there; of how many measures a radian is there.
struct Angles {
  std::vector<double> nodes;
  double point, distance, per_radian;
};
Angles angles(bool pinhole, const std::vector<double>& measures, double measure, double distance) {
  if (!pinhole) return {measures, measure, distance, 1};
  Angles found{{}, std::atan(measure), distance, 1 + measure * measure};
  for (const double m : measures) found.nodes.push_back(std::atan(m));
  return found;
}

}  // namespace

// Every node whose ray passes within the gate is tried.
ClosestSampleCase::Output ClosestSampleCase::reference(const Input& in) {
  Output out;
  const double facing = std::cos(in.normal_deg * std::numbers::pi / 180);
  const auto rows = static_cast<int>(in.rows.size()), cols = static_cast<int>(in.cols.size());
  for (std::size_t i = 0; i < in.x.size(); ++i) {
    const Vec3 p = in.grid_from_scan * Vec3(in.x[i], in.y[i], in.z[i]),
               n = in.grid_from_scan.rotate(Vec3(in.nx[i], in.ny[i], in.nz[i]));
    double best = kNone, second = kNone, height = kNone, clearance = kNone;
    Vec3 normal = Vec3::Constant(kNone);
    bool doubtful = false;
    const double row_at = in.row_of(p), col_at = in.col_of(p);
    const double steps = steps_outside(in, row_at, col_at);
    const bool inside = !p.hasNaN() && steps < kMostSteps && (!in.is_pinhole() || p.x() > 0);
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
      const auto row = static_cast<int>(nearest(in.rows, row_at, doubtful)),
                 col = static_cast<int>(nearest(in.cols, col_at, doubtful));
      for (int r = row - 1; r <= row + 1; ++r)
        for (int c = col - 1; c <= col + 1; ++c)
          visit(r, c,
                [&](const Vec3& q, const Vec3&) { clearance = std::fmin(clearance, q.norm() - p.norm()); });
      const bool pinhole = in.is_pinhole();
      const Angles up = angles(pinhole, in.rows, row_at, pinhole ? std::hypot(p.x(), p.z()) : p.norm()),
                   around = angles(pinhole, in.cols, col_at, p.head<2>().norm());
      const auto widest = [&](const Angles& of) { return std::asin(std::min(gate / of.distance, 1.0)); };
      const auto is_strided = [&](const Angles& of, double step) {
        return gate / of.distance * of.per_radian > CLOSEST_SAMPLE_WINDOW * step * 0.99;
      };
      const double wide_up = widest(up), wide_around = widest(around);
      strided = is_strided(up, (in.rows.front() - in.rows.back()) / (rows - 1)) ||
                is_strided(around, (in.cols.back() - in.cols.front()) / (cols - 1));
      for (int r = 0; r < rows; ++r) {
        if (std::abs(up.nodes[static_cast<std::size_t>(r)] - up.point) > wide_up) continue;
        for (int c = 0; c < cols; ++c) {
          if (angle_between(around.nodes[static_cast<std::size_t>(c)], around.point) > wide_around) continue;
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
