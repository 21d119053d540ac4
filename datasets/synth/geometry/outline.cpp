#include "geometry/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace synth {

int pieces_of_arc(double radius, double angle) {
  const double chord = 2 * std::acos(std::max(0.5, 1 - kSagitta_m / radius));
  return std::max(1, static_cast<int>(std::ceil(std::abs(angle) / chord)));
}

void Outline::arc(const Vec2& centre, double radius, double from, double to, int number) {
  const int pieces = pieces_of_arc(radius, to - from);
  for (int k = 0; k < pieces; ++k) {
    const double angle = from + (to - from) * k / pieces;
    points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
    curve.push_back(number);
  }
}

Outline rectangle(double left, double bottom, double right, double top) {
  return {{{left, bottom}, {right, bottom}, {right, top}, {left, top}}, {0, 0, 0, 0}};
}

Outline circle(const Vec2& centre, double radius) {
  Outline ring;
  ring.arc(centre, radius, 0, 2 * std::numbers::pi, 1);
  return ring;
}

double apex(double half_width, double springing, double sharpness) {
  const double radius = 2 * half_width * sharpness, reach = radius - half_width;
  return springing + std::sqrt(radius * radius - reach * reach);
}

Outline arched(double middle, double half_width, double bottom, double springing, double sharpness) {
  const double radius = 2 * half_width * sharpness, reach = radius - half_width;
  const double top = std::acos(reach / radius);  // angle of the apex seen from an arc's centre
  Outline ring;
  ring.line_to({middle - half_width, bottom});
  ring.line_to({middle + half_width, bottom});
  ring.arc({middle - reach, springing}, radius, 0, top, 1);
  ring.arc({middle + reach, springing}, radius, std::numbers::pi - top, std::numbers::pi,
           sharpness > 0.5 ? 2 : 1);
  ring.line_to({middle - half_width, springing});
  return ring;
}

std::vector<Vec2> mitres(const std::vector<Vec2>& points, bool closed) {
  const std::size_t n = points.size();
  const auto normal_of_edge = [&](std::size_t k) {
    const Vec2 along = (points[(k + 1) % n] - points[k]).normalized();
    return Vec2(along.y(), -along.x());
  };
  std::vector<Vec2> result;
  for (std::size_t k = 0; k < n; ++k) {
    const bool first = !closed && k == 0, last = !closed && k + 1 == n;
    const Vec2 after = normal_of_edge(last ? k - 1 : k), before = normal_of_edge(first ? k : (k + n - 1) % n);
    const Vec2 sum = before + after;
    result.push_back(2 * sum / std::max(0.2, sum.squaredNorm()));
  }
  return result;
}

Outline grown(const Outline& outline, double distance) {
  Outline result = outline;
  const std::vector<Vec2> outwards = mitres(outline.points, true);
  for (std::size_t k = 0; k < result.points.size(); ++k) result.points[k] += distance * outwards[k];
  return result;
}

}  // namespace synth
