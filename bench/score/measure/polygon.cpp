#include "score/measure/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace score {

PlanePolygon::PlanePolygon(const Plane& plane, const std::vector<std::vector<Vec3>>& rings)
    : plane_(plane), axes_(axes_across(plane.normal)) {
  for (const auto& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i)
      edges_.push_back({flat(ring[i]), flat(ring[(i + 1) % ring.size()])});
  if (edges_.empty()) return;
  low_ = high_ = edges_[0].a.y();
  for (const Edge& edge : edges_) {
    low_ = std::min(low_, edge.a.y());
    high_ = std::max(high_, edge.a.y());
  }
  strips_.resize(std::max<std::size_t>(1, edges_.size() / 2));
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [first, last] = std::minmax({strip_of(edges_[i].a.y()), strip_of(edges_[i].b.y())});
    for (std::size_t strip = first; strip <= last; ++strip)
      strips_[strip].push_back(static_cast<std::uint32_t>(i));
  }
}

std::size_t PlanePolygon::strip_of(double y) const {
  const double share = high_ > low_ ? (y - low_) / (high_ - low_) : 0;
  const auto strip = static_cast<std::size_t>(share * static_cast<double>(strips_.size()));
  return std::min(strip, strips_.size() - 1);
}

bool PlanePolygon::covers(const Vec2& point) const {
  if (edges_.empty() || !(point.y() >= low_ && point.y() <= high_)) return false;
  bool inside = false;
  for (const std::uint32_t i : strips_[strip_of(point.y())]) {
    const auto& [a, b] = edges_[i];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double x = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    inside ^= point.x() < x;
  }
  return inside;
}

double PlanePolygon::edge_distance_m(const Vec2& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : edges_) {
    const Vec2 along = b - a;
    const double length = along.squaredNorm();
    const double share = length > 0 ? std::clamp((point - a).dot(along) / length, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (point - a - share * along).squaredNorm());
  }
  return std::sqrt(nearest);
}

double PlanePolygon::distance_m(const Vec3& point) const {
  const double off_plane = std::abs(plane_.normal.dot(point) - plane_.offset_m);
  const Vec2 foot = flat(point);
  return covers(foot) ? off_plane : std::hypot(off_plane, edge_distance_m(foot));
}

}  // namespace score
