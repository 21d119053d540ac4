#include "stages/planes/cylinder_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cpu_clones.hpp"
#include "core/lanes.hpp"

// Sums over all points, as loops over lanes of fixed order (ray_equations.cpp says why; compiled with options
// of its own, host/CMakeLists.txt).
namespace hybrid::stages {
namespace {

// With p, q the outward direction along `across`, negative, t the place along the axis from the middle and r
// the distance: each times 1, t, t^2 or 1, t.
constexpr std::size_t kSumsOfPoint = 26;
enum Term : std::size_t {
  kPp = 0,
  kPq = 3,
  kQq = 6,
  kP = 9,
  kQ = 12,
  kOne = 15,
  kRp = 18,
  kRq = 20,
  kR = 22
};
constexpr std::size_t kSquares = 24, kWithin = 25;

constexpr double kOnAxis_m = 1e-12;  // a point nearer to the axis is in no direction from it

// A cylinder in plain numbers.
struct Axis {
  double fx, fy, fz, ax, ay, az, radius, taper, middle;

  explicit Axis(const Cylinder& of)
      : fx(of.foot.x()),
        fy(of.foot.y()),
        fz(of.foot.z()),
        ax(of.axis.x()),
        ay(of.axis.y()),
        az(of.axis.z()),
        radius(of.radius_m),
        taper(of.taper),
        middle(0.5 * of.length_m) {}
};

// One point as a cylinder has it.
struct Seen {
  double along, x, y, z, radius, distance;  // x, y, z: from the axis outwards

  HYBRID_INLINE Seen(const Axis& axis, double px, double py, double pz) {
    const double dx = px - axis.fx, dy = py - axis.fy, dz = pz - axis.fz;
    along = axis.ax * dx + (axis.ay * dy + axis.az * dz);
    x = dx - along * axis.ax;
    y = dy - along * axis.ay;
    z = dz - along * axis.az;
    radius = std::sqrt(x * x + (y * y + z * z));
    distance = radius - axis.radius - axis.taper * (along - axis.middle);
  }
};

}  // namespace

CylinderPoints::CylinderPoints(const std::vector<Vec3>& points) {
  const std::size_t whole = (points.size() + kVectorLanes - 1) / kVectorLanes * kVectorLanes;
  for (auto* const values : {&x_, &y_, &z_, &counts_}) values->resize(whole);
  for (std::size_t k = 0; k < points.size(); ++k) {
    x_[k] = points[k].x();
    y_[k] = points[k].y();
    z_[k] = points[k].z();
    counts_[k] = 1;
  }
}

HYBRID_CPU_CLONES
CylinderPoints::Sums CylinderPoints::sums(const Cylinder& at, const std::array<Vec3, 2>& across,
                                          double reach_m) const {
  const Axis axis(at);
  const double inverse_reach = 1 / reach_m;
  const double p0 = -across[0].x(), p1 = -across[0].y(), p2 = -across[0].z();
  const double q0 = -across[1].x(), q1 = -across[1].y(), q2 = -across[1].z();
  alignas(64) std::array<LaneValues, kSumsOfPoint> terms{};
  for (std::size_t from = 0; from < x_.size(); from += kVectorLanes) {
    alignas(64) LaneValues ts, rs, ps, qs, ws, counts;
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      const Seen seen(axis, x_[from + k], y_[from + k], z_[from + k]);
      const double r = seen.distance, u = r * inverse_reach, one = 1 - u * u;
      const double inverse = 1 / std::max(seen.radius, kOnAxis_m);
      ts[k] = seen.along - axis.middle;
      rs[k] = r;
      ps[k] = inverse * (seen.x * p0 + (seen.y * p1 + seen.z * p2));
      qs[k] = inverse * (seen.x * q0 + (seen.y * q1 + seen.z * q2));
      counts[k] = one > 0 ? counts_[from + k] : 0.0;
      ws[k] = counts[k] * (one * one);
    }
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      const double t = ts[k], r = rs[k], p = ps[k], q = qs[k], w = ws[k];
      const double wt = w * t, wtt = wt * t, wr = w * r, wrt = wr * t;
      const auto add = [&](std::size_t term, double value) {
        terms[term][k] += w * value;
        terms[term + 1][k] += wt * value;
        terms[term + 2][k] += wtt * value;
      };
      add(kPp, p * p);
      add(kPq, p * q);
      add(kQq, q * q);
      add(kP, p);
      add(kQ, q);
      add(kOne, 1);
      terms[kRp][k] += wr * p;
      terms[kRp + 1][k] += wrt * p;
      terms[kRq][k] += wr * q;
      terms[kRq + 1][k] += wrt * q;
      terms[kR][k] += wr;
      terms[kR + 1][k] += wrt;
      terms[kSquares][k] += wr * r;
      terms[kWithin][k] += counts[k];
    }
  }
  std::array<double, kSumsOfPoint> s;
  for (std::size_t t = 0; t < kSumsOfPoint; ++t) s[t] = sum_of_lanes(terms[t]);
  Sums sums;
  sums.matrix << s[kPp], s[kPq], s[kPp + 1], s[kPq + 1], -s[kP], -s[kP + 1],   //
      s[kPq], s[kQq], s[kPq + 1], s[kQq + 1], -s[kQ], -s[kQ + 1],              //
      s[kPp + 1], s[kPq + 1], s[kPp + 2], s[kPq + 2], -s[kP + 1], -s[kP + 2],  //
      s[kPq + 1], s[kQq + 1], s[kPq + 2], s[kQq + 2], -s[kQ + 1], -s[kQ + 2],  //
      -s[kP], -s[kQ], -s[kP + 1], -s[kQ + 1], s[kOne], s[kOne + 1],            //
      -s[kP + 1], -s[kQ + 1], -s[kP + 2], -s[kQ + 2], s[kOne + 1], s[kOne + 2];
  sums.right << -s[kRp], -s[kRq], -s[kRp + 1], -s[kRq + 1], s[kR], s[kR + 1];
  sums.squares = s[kSquares];
  sums.weight = s[kOne];
  sums.within = static_cast<std::size_t>(std::llround(s[kWithin]));
  return sums;
}

HYBRID_CPU_CLONES
std::pair<double, double> CylinderPoints::extent(const Cylinder& at, double reach_m) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const Axis axis(at);
  alignas(64) LaneValues low, high;
  low.fill(kFar);
  high.fill(-kFar);
  for (std::size_t from = 0; from < x_.size(); from += kVectorLanes)
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      const Seen seen(axis, x_[from + k], y_[from + k], z_[from + k]);
      const double counts = std::abs(seen.distance) <= reach_m ? counts_[from + k] : 0.0;
      const double lower = counts > 0 ? seen.along : kFar, upper = counts > 0 ? seen.along : -kFar;
      low[k] = lower < low[k] ? lower : low[k];
      high[k] = upper > high[k] ? upper : high[k];
    }
  return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

}  // namespace hybrid::stages
