#include "geometry/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.hpp"

namespace hybrid {
namespace {

// q(s) and dq/ds.
struct Radial {
  double value, slope;
};

Radial brown_radial(const Camera& c, double s) {
  const double above = 1 + s * (c.k1 + s * (c.k2 + s * c.k3)), below = 1 + s * (c.k4 + s * (c.k5 + s * c.k6));
  const double above_slope = c.k1 + s * (2 * c.k2 + 3 * s * c.k3),
               below_slope = c.k4 + s * (2 * c.k5 + 3 * s * c.k6);
  return {above / below, (above_slope - above / below * below_slope) / below};
}

double fisheye_radius(const Camera& c, double angle) {
  const double t = angle * angle;
  return angle * (1 + t * (c.k1 + t * (c.k2 + t * (c.k3 + t * c.k4))));
}

Vec2 distort(const Camera& c, const Vec2& p) {
  const double s = p.squaredNorm(), radius = std::sqrt(s);
  if (c.lens == Lens::fisheye)
    return radius > 0 ? Vec2(p * (fisheye_radius(c, std::atan(radius)) / radius)) : p;
  const double q = brown_radial(c, s).value;
  return {p.x() * q + 2 * c.p1 * p.x() * p.y() + c.p2 * (s + 2 * p.x() * p.x()),
          p.y() * q + 2 * c.p2 * p.x() * p.y() + c.p1 * (s + 2 * p.y() * p.y())};
}

using Polynomial = std::vector<double>;  // coefficients from the constant one up

double value_at(const Polynomial& polynomial, double s) {
  double value = 0;
  for (std::size_t i = polynomial.size(); i-- > 0;) value = value * s + polynomial[i];
  return value;
}

// Where the polynomial changes its sign at positive s, ascending: between the extrema, by bisection.
std::vector<double> sign_changes(Polynomial polynomial) {
  while (!polynomial.empty() && polynomial.back() == 0) polynomial.pop_back();
  if (polynomial.size() < 2) return {};
  Polynomial slope;
  double largest = 0;
  for (std::size_t i = 1; i < polynomial.size(); ++i) {
    slope.push_back(static_cast<double>(i) * polynomial[i]);
    largest = std::max(largest, std::abs(polynomial[i - 1] / polynomial.back()));
  }
  std::vector<double> borders = sign_changes(slope), result;
  borders.push_back(1 + largest);  // beyond it there is none (Cauchy's bound)
  double low = 0;
  for (double high : borders) {
    const double start = low, sign = value_at(polynomial, start);
    low = high;
    if ((sign > 0) == (value_at(polynomial, high) > 0)) continue;
    double left = start, right = high;
    for (double middle = (left + right) / 2; middle > left && middle < right; middle = (left + right) / 2)
      ((sign > 0) == (value_at(polynomial, middle) > 0) ? left : right) = middle;
    result.push_back(right);
  }
  return result;
}

double first_sign_change(const Polynomial& polynomial) {
  const auto changes = sign_changes(polynomial);
  return changes.empty() ? std::numeric_limits<double>::infinity() : changes.front();
}

// The angle whose fisheye radius this is, at most `largest`.
double fisheye_angle(const Camera& c, double radius, double largest) {
  double low = 0, high = largest, angle = std::min(radius, largest);
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double t = angle * angle, error = fisheye_radius(c, angle) - radius;
    if (std::abs(error) < 1e-15) break;
    (error > 0 ? high : low) = angle;
    const double slope = 1 + t * (3 * c.k1 + t * (5 * c.k2 + t * (7 * c.k3 + t * 9 * c.k4)));
    angle -= error / slope;
    if (!(angle > low && angle < high)) angle = (low + high) / 2;
  }
  return angle;
}

constexpr double kRightAngle = std::numbers::pi / 2;

// Camera::max_radius2() of one with distortion.
double growth_radius2(const Camera& c) {
  if (c.lens == Lens::fisheye) {
    const double angle = std::sqrt(first_sign_change({1, 3 * c.k1, 5 * c.k2, 7 * c.k3, 9 * c.k4}));
    return angle < kRightAngle ? std::tan(angle) * std::tan(angle) : std::numeric_limits<double>::infinity();
  }
  // The numerator of d/dr of r N(s) / D(s), s = r^2: (N + 2 s N') D - 2 s N D'; and the poles of D.
  const double n[4] = {1, c.k1, c.k2, c.k3}, d[4] = {1, c.k4, c.k5, c.k6};
  Polynomial slope(7, 0.0);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) slope[static_cast<std::size_t>(i + j)] += (1 + 2 * i - 2 * j) * n[i] * d[j];
  return std::min(first_sign_change(slope), first_sign_change({d[0], d[1], d[2], d[3]}));
}

// A panorama's pixel before it is held against the image's borders; NaN on the camera's centre, and on the
// axis of a cylinder.
Vec2 panorama_pixel(const Camera& c, const Vec3& p) {
  const double level = std::hypot(p.x(), p.z()), turn = 2 * std::numbers::pi * c.fx;
  double column = c.fx * std::atan2(p.x(), p.z()) + c.cx;
  if (column < 0) column += turn;
  if (column >= turn) column -= turn;
  if (c.wraps() && column >= c.width) column -= c.width;  // rounding
  if (c.lens == Lens::cylindrical) return {column, c.fy * p.y() / level + c.cy};
  double row = p.isZero() ? std::numeric_limits<double>::quiet_NaN() : c.fy * std::atan2(p.y(), level) + c.cy;
  if (c.reaches_zenith()) row = std::max(row, 0.0);
  if (c.reaches_nadir()) row = std::min(row, std::nextafter(c.height, 0));
  return {column, row};
}

Vec3 panorama_ray(const Camera& c, const Vec2& pixel) {
  const double azimuth = (pixel.x() - c.cx) / c.fx, v = (pixel.y() - c.cy) / c.fy;
  const Vec3 level(std::sin(azimuth), 0, std::cos(azimuth));
  if (c.lens == Lens::cylindrical) return (level + Vec3(0, v, 0)).normalized();
  if (std::abs(v) > kRightAngle) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  return std::cos(v) * level + Vec3(0, std::sin(v), 0);
}

}  // namespace

bool Camera::wraps() const {
  return panorama() && std::abs(2 * std::numbers::pi * fx - width) < 0.5;
}

bool Camera::reaches_zenith() const {
  return lens == Lens::spherical && cy - kRightAngle * fy > -0.5;
}

bool Camera::reaches_nadir() const {
  return lens == Lens::spherical && cy + kRightAngle * fy < height + 0.5;
}

double Camera::max_radius2() const {
  const std::array<double, 6> radial = {k1, k2, k3, k4, k5, k6};
  if (radial == std::array<double, 6>{}) return std::numeric_limits<double>::infinity();
  // Pixel after pixel asks for the same lens: a thread keeps its last answer.
  struct Answer {
    Lens lens = Lens::brown;
    std::array<double, 6> radial{};
    double radius2 = 0;
  };
  thread_local Answer last;
  if (last.lens != lens || last.radial != radial) last = {lens, radial, growth_radius2(*this)};
  return last.radius2;
}
std::optional<Vec2> Camera::project(const Vec3& point_in_cam) const {
  Vec2 pixel;
  if (panorama()) {
    pixel = panorama_pixel(*this, point_in_cam);
  } else {
    if (!(point_in_cam.z() > 0)) return std::nullopt;
    const Vec2 p = point_in_cam.head<2>() / point_in_cam.z();
    if (!(p.squaredNorm() < max_radius2())) return std::nullopt;
    const Vec2 d = distort(*this, p);
    pixel = Vec2(fx * d.x() + cx, fy * d.y() + cy);
  }
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width && pixel.y() < height)) return std::nullopt;
  return pixel;
}

Vec3 Camera::ray(const Vec2& pixel) const {
  if (panorama()) return panorama_ray(*this, pixel);
  const Vec2 target((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  const Vec3 none = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  const double largest2 = max_radius2(), radius = target.norm();
  if (lens == Lens::fisheye) {
    const double largest = std::atan(std::sqrt(largest2));
    if (!(radius < fisheye_radius(*this, largest))) return none;
    const double angle = fisheye_angle(*this, radius, largest);
    const Vec2 side = radius > 0 ? Vec2(target / radius * std::sin(angle)) : Vec2(0, 0);
    return Vec3(side.x(), side.y(), std::cos(angle));
  }
  Vec2 p = target;
  // Strong distortion may want more than the plain guess: start inside the radius of growth.
  if (p.squaredNorm() >= largest2) p *= 0.9 * std::sqrt(largest2) / radius;
  Vec2 error = distort(*this, p) - target;
  for (int iteration = 0; iteration < 50 && error.squaredNorm() > 1e-28; ++iteration) {
    const double s = p.squaredNorm(), x = p.x(), y = p.y();
    const Radial q = brown_radial(*this, s);
    Eigen::Matrix2d jacobian;
    jacobian << q.value + 2 * x * x * q.slope + 2 * p1 * y + 6 * p2 * x,
        2 * x * y * q.slope + 2 * p1 * x + 2 * p2 * y, 2 * x * y * q.slope + 2 * p2 * y + 2 * p1 * x,
        q.value + 2 * y * y * q.slope + 2 * p2 * x + 6 * p1 * y;
    const Vec2 step = jacobian.inverse() * error;
    // Half steps where a whole one would leave the radius of growth or not come nearer.
    double share = 1;
    for (int halving = 0; halving < 20; ++halving, share /= 2) {
      const Vec2 next = p - share * step;
      if (next.squaredNorm() < largest2 && (distort(*this, next) - target).norm() < error.norm()) break;
    }
    p -= share * step;
    error = distort(*this, p) - target;
  }
  if (!(error.squaredNorm() < 1e-16 && p.squaredNorm() < largest2)) return none;
  return Vec3(p.x(), p.y(), 1).normalized();
}

namespace {

// At `eye`: z towards `target`, or, where the camera stays upright, as far as that is level; y away from
// `up`.
Photograph placed(const Vec3& eye, const Vec3& target, const Vec3& up, bool upright, int width, int height) {
  if (!eye.allFinite() || !target.allFinite() || !up.allFinite())
    fail_input("view: eye, target and up: expected finite numbers");
  if (width < 1 || height < 1)
    fail_input("view: size: expected at least 1 x 1, found {} x {}", width, height);
  if ((target - eye).norm() < 1e-9) fail_input("view: eye and target coincide; move one of them");
  Vec3 forward = (target - eye).normalized();
  const Vec3 right = forward.cross(up);
  if (right.norm() < 1e-6 * up.norm() || up.norm() == 0)
    fail_input("view: up is parallel to the direction from eye to target; choose another up");
  if (upright) forward = up.cross(right).normalized();
  Mat3 cam_from_world;
  cam_from_world.row(0) = right.normalized();
  cam_from_world.row(1) = forward.cross(right.normalized());
  cam_from_world.row(2) = forward;
  Photograph view;
  view.camera.width = width;
  view.camera.height = height;
  view.camera.cx = 0.5 * width;
  view.camera.cy = 0.5 * height;
  view.cam_from_world.rotation = Eigen::Quaterniond(cam_from_world);
  view.cam_from_world.translation = -(cam_from_world * eye);
  return view;
}

}  // namespace

Photograph look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double fov_deg, int width,
                   int height) {
  if (!(fov_deg > 0 && fov_deg < 170))
    fail_input("view: fov_deg: expected more than 0, below 170, found {}", fov_deg);
  Photograph view = placed(eye, target, up, false, width, height);
  view.camera.fx = view.camera.fy = 0.5 * height / std::tan(0.5 * fov_deg * std::numbers::pi / 180);
  return view;
}

Photograph look_around(const Vec3& eye, const Vec3& target, const Vec3& up, int width, int height) {
  Photograph view = placed(eye, target, up, true, width, height);
  if (width != 2 * height)
    fail_input("view: size: expected a panorama twice as wide as high, found {} x {}", width, height);
  view.camera.lens = Lens::spherical;
  view.camera.fx = view.camera.fy = height / std::numbers::pi;
  return view;
}

}  // namespace hybrid
