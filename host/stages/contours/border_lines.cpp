#include "stages/contours/border_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "stages/contours/widened_rings.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kLeastPoints = 8;    // of a contour along a line
constexpr double kLongSide = 2.5;          // steps without a point between: two planes meet there
constexpr double kLeastMeetingSine = 0.2;  // of lines that meet in a corner
constexpr double kMostToCorner = 2;        // steps from the contour's point there
constexpr double kSamePlace_m = 1e-6;

// The line through a run of points.
struct BorderLine {
  Vec2 middle, along;
  double rms_m = 0;

  Vec2 nearest(const Vec2& point) const { return middle + along.dot(point - middle) * along; }
  double off_m(const Vec2& point) const {
    return std::abs(along.x() * (point - middle).y() - along.y() * (point - middle).x());
  }
};

// From a contour's point to another one, counted on where it begins anew.
struct Stretch {
  std::size_t first = 0, last = 0;
  bool exact = false;  // on a line that is known
  std::size_t inner() const { return last - first - 1; }
};

class Border {
 public:
  Border(const Plane& plane, const std::vector<Vec3>& points, double step_rad)
      : points_(points),
        step_rad_(step_rad),
        origin_(points[0]),
        u_(plane.normal.unitOrthogonal()),
        v_(plane.normal.cross(u_)) {
    const std::size_t n = points.size();
    sums_.assign(2 * n + 1, Sums{});
    for (std::size_t i = 0; i < n; ++i)
      flat_.push_back({u_.dot(points[i] - origin_), v_.dot(points[i] - origin_)});
    for (std::size_t i = 0; i < 2 * n; ++i) {
      const Vec2& p = flat_[i % n];
      sums_[i + 1] = sums_[i];
      sums_[i + 1].first += p;
      sums_[i + 1].second += p * p.transpose();
    }
  }

  const Vec2& at(std::size_t i) const { return flat_[i % flat_.size()]; }
  Vec3 lifted(const Vec2& p) const { return origin_ + p.x() * u_ + p.y() * v_; }

  // Of the scan's grid at a point, across a direction.
  double step_m(std::size_t i, const Vec2& along) const {
    return step_rad_ * step_across(points_[i % points_.size()], -along.y() * u_ + along.x() * v_);
  }

  // Through the points between its ends, which are corners; through its ends where it is exact.
  BorderLine line(const Stretch& side) const {
    if (side.exact) return {at(side.first), (at(side.last) - at(side.first)).normalized(), 0};
    const Sums &from = sums_[side.first + 1], &to = sums_[side.last];
    const auto count = static_cast<double>(side.inner());
    const Vec2 middle = (to.first - from.first) / count;
    const Eigen::Matrix2d spread = (to.second - from.second) / count - middle * middle.transpose();
    const double half = 0.5 * (spread(0, 0) - spread(1, 1)), mean = 0.5 * (spread(0, 0) + spread(1, 1));
    const double root = std::hypot(half, spread(0, 1));
    const double angle = 0.5 * std::atan2(spread(0, 1), half);
    BorderLine found{middle, {std::cos(angle), std::sin(angle)}, std::sqrt(std::max(mean - root, 0.0))};
    if (found.along.dot(at(side.last) - at(side.first)) < 0) found.along = -found.along;
    return found;
  }

  bool is_straight(const Stretch& side, double rms_steps, double most_steps) const {
    if (side.exact || side.inner() < kLeastPoints || side.last - side.first >= flat_.size()) return false;
    const BorderLine fit = line(side);
    if (fit.rms_m > rms_steps * step_m(side.first + side.inner() / 2, fit.along)) return false;
    for (std::size_t i = side.first; i <= side.last; ++i)
      if (fit.off_m(at(i)) > most_steps * step_m(i, fit.along)) return false;
    return true;
  }

  bool is_long(std::size_t i) const {
    const Vec2 along = at(i + 1) - at(i);
    return along.norm() > kLongSide * step_m(i, Vec2(-along.y(), along.x()).normalized());
  }

 private:
  struct Sums {
    Vec2 first = Vec2::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  };
  const std::vector<Vec3>& points_;
  double step_rad_;
  Vec3 origin_, u_, v_;
  std::vector<Vec2> flat_;
  std::vector<Sums> sums_;  // of the points before, twice around
};

// Where a ring's vertices are among a contour's points; nothing where one of them is not, in order.
std::optional<std::vector<std::size_t>> places_in(const FlatRing& ring, const ContourRing& contour) {
  std::vector<std::size_t> places;
  std::size_t i = 0;
  for (const RingVertex& vertex : ring.vertices) {
    while (i < contour.points.size() && contour.points[i] != vertex.point) ++i;
    if (i == contour.points.size()) return std::nullopt;
    places.push_back(i++);
  }
  return places;
}

// Sides between the ring's vertices, of which two in a row become one where together they are straight, the
// straightest first.
class Sides {
 public:
  Sides(const Border& border, const std::vector<std::size_t>& places, std::size_t count, double rms_steps,
        double most_steps)
      : border_(border), rms_steps_(rms_steps), most_steps_(most_steps) {
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::size_t last = k + 1 < places.size() ? places[k + 1] : places[0] + count;
      sides_.push_back({places[k], last, last == places[k] + 1 && border.is_long(places[k])});
    }
    for (std::size_t k = 0; k < sides_.size(); ++k) rms_m_.push_back(rms_with_next(k));
  }

  std::vector<Stretch> joined() {
    while (sides_.size() > 3) {
      const auto straightest = std::min_element(rms_m_.begin(), rms_m_.end());
      if (!std::isfinite(*straightest)) break;
      join(static_cast<std::size_t>(straightest - rms_m_.begin()));
    }
    return sides_;
  }

 private:
  std::size_t next_of(std::size_t k) const { return (k + 1) % sides_.size(); }

  Stretch with_next(std::size_t k) const {
    const Stretch &own = sides_[k], &next = sides_[next_of(k)];
    return {own.first, own.last + (next.last - next.first), own.exact || next.exact};
  }

  double rms_with_next(std::size_t k) const {
    const Stretch both = with_next(k);
    return border_.is_straight(both, rms_steps_, most_steps_) ? border_.line(both).rms_m
                                                              : std::numeric_limits<double>::infinity();
  }

  void join(std::size_t k) {
    const std::size_t next = next_of(k);
    sides_[k] = with_next(k);
    sides_.erase(sides_.begin() + static_cast<std::ptrdiff_t>(next));
    rms_m_.erase(rms_m_.begin() + static_cast<std::ptrdiff_t>(next));
    const std::size_t own = next < k ? k - 1 : k;
    const std::size_t before = (own + sides_.size() - 1) % sides_.size();
    for (const std::size_t changed : {own, before}) rms_m_[changed] = rms_with_next(changed);
  }

  const Border& border_;
  double rms_steps_, most_steps_;
  std::vector<Stretch> sides_;
  std::vector<double> rms_m_;  // of a side and the next one along one line; infinite where they are none
};

FlatRing lined(const FlatRing& ring, const ContourRing& contour, const std::vector<std::size_t>& places,
               const Plane& plane, double step_rad, double rms_steps, double most_steps) {
  const Border border(plane, contour.points, step_rad);
  const auto sides = Sides(border, places, contour.points.size(), rms_steps, most_steps).joined();
  std::vector<std::optional<BorderLine>> lines;
  for (const Stretch& side : sides)
    lines.push_back(side.exact || border.is_straight(side, rms_steps, most_steps)
                        ? std::optional(border.line(side))
                        : std::nullopt);
  const PlaneCoordinates coordinates(plane);
  FlatRing result{{}, ring.outer};
  const auto add = [&](const Vec2& point) {
    const Vec3 place = border.lifted(point);
    if (result.vertices.empty() || (place - result.vertices.back().point).norm() > kSamePlace_m)
      result.vertices.push_back(coordinates.vertex(place));
  };
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const auto &before = lines[(k + lines.size() - 1) % lines.size()], &after = lines[k];
    const std::size_t i = sides[k].first;
    const Vec2& corner = border.at(i);
    if (!before && !after) {
      add(corner);
    } else if (before && after) {
      const double sine = before->along.x() * after->along.y() - before->along.y() * after->along.x();
      if (std::abs(sine) >= kLeastMeetingSine) {
        const Vec2 apart = after->middle - before->middle;
        const Vec2 met = before->middle +
                         (apart.x() * after->along.y() - apart.y() * after->along.x()) / sine * before->along;
        if ((met - corner).norm() <=
            kMostToCorner * std::max(border.step_m(i, before->along), border.step_m(i, after->along))) {
          add(met);
          continue;
        }
      }
      add(before->nearest(corner));
      add(after->nearest(corner));
    } else {
      add((before ? before : after)->nearest(corner));
    }
  }
  return result;
}

}  // namespace

std::vector<FlatRing> with_border_lines(const RangeImage& image, const Supercluster& supercluster,
                                        const std::vector<FlatRing>& rings, double rms_steps,
                                        double most_steps) {
  std::vector<FlatRing> result;
  std::size_t contour = 0;
  for (const FlatRing& ring : rings) {
    result.push_back(ring);
    for (std::size_t c = contour; c < supercluster.contours.size(); ++c) {
      const auto places = places_in(ring, supercluster.contours[c]);
      if (!places) continue;
      contour = c + 1;
      FlatRing straight = lined(ring, supercluster.contours[c], *places, supercluster.plane, image.step_rad(),
                                rms_steps, most_steps);
      if (straight.vertices.size() >= 3 && (signed_area2(straight) > 0) == (signed_area2(ring) > 0))
        result.back() = std::move(straight);
      break;
    }
  }
  restore_touching(result, rings);
  return result;
}

}  // namespace hybrid::stages
