#include "stages/rendering/opening_contents.hpp"

#include <algorithm>
#include <cmath>

#include "stages/rendering/unseen_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSameSize_m = 0.04, kSameArea = 0.03;  // of one design
constexpr double kSameGlass_m = 0.03;
constexpr double kSymmetric_m = 0.03;  // between an outline and its mirror image
constexpr double kAround_m = 0.06;     // an opening, what stands in it
constexpr double kBeforeWall_m = 0.05;
constexpr double kOnGlass_m = 0.02;

// A point of an opening: from its box' middle right and up, and before the wall.
struct Place {
  Vec2 at;
  double before_m;
};

class OpeningShape {
 public:
  explicit OpeningShape(const GlazedOpening& opening)
      : opening_(opening), area_m2_(signed_area(opening.ring)) {
    const Box2 box = box_of(opening.ring);
    middle_ = 0.5 * (box.low + box.high);
    size_ = box.high - box.low;
    symmetric_ = std::all_of(opening.ring.begin(), opening.ring.end(), [&](const Vec2& point) {
      return distance_to_border(opening.ring, {2 * middle_.x() - point.x(), point.y()}) <= kSymmetric_m;
    });
  }

  bool is_symmetric() const { return symmetric_; }
  Vec3 centre() const { return world({Vec2::Zero(), 0}); }

  bool is_alike(const OpeningShape& other) const {
    return (size_ - other.size_).cwiseAbs().maxCoeff() < kSameSize_m &&
           std::abs(area_m2_ - other.area_m2_) < kSameArea * area_m2_ &&
           std::abs(opening_.pane_m - other.opening_.pane_m) < kSameGlass_m;
  }

  Place place(const Vec3& point) const {
    return {opening_.frame.flat(point) - middle_, opening_.frame.plane.distance(point)};
  }
  Vec3 world(const Place& place) const { return opening_.frame.world(place.at + middle_, place.before_m); }

  // Between the wall's face and the glass, and not on that.
  bool holds(const SpacePolygon& polygon) const {
    bool before_glass = false;
    for (const Vec3& point : polygon.outer) {
      const auto [at, before_m] = place(point);
      if (before_m > kBeforeWall_m || before_m < -opening_.pane_m - kOnGlass_m) return false;
      before_glass = before_glass || before_m > -opening_.pane_m + kOnGlass_m;
      const Vec2 flat = at + middle_;
      if (!inside(opening_.ring, flat) && distance_to_border(opening_.ring, flat) > kAround_m) return false;
    }
    return before_glass;
  }

 private:
  const GlazedOpening& opening_;
  double area_m2_;
  Vec2 middle_, size_;
  bool symmetric_;
};

SpacePolygon copied(const SpacePolygon& polygon, const OpeningShape& from, const OpeningShape& to,
                    bool mirrored) {
  const auto moved = [&](std::vector<Vec3> ring) {
    for (Vec3& point : ring) {
      Place place = from.place(point);
      if (mirrored) place.at.x() = -place.at.x();
      point = to.world(place);
    }
    if (mirrored) std::reverse(ring.begin(), ring.end());
    return ring;
  };
  SpacePolygon copy{moved(polygon.outer), {}};
  for (const auto& hole : polygon.holes) copy.holes.push_back(moved(hole));
  return copy;
}

}  // namespace

std::vector<OpeningContent> opening_contents(const ScanSight& sight, const PolygonModel& contours,
                                             const std::vector<GlazedOpening>& openings) {
  const std::vector<OpeningShape> shapes(openings.begin(), openings.end());
  std::vector<std::vector<std::pair<std::size_t, SpacePolygon>>> seen(openings.size());
  for (std::size_t f = 0; f < contours.faces.size(); ++f) {
    const SpacePolygon polygon = polygon_of(contours, contours.faces[f]);
    for (std::size_t k = 0; k < shapes.size(); ++k)
      if (shapes[k].holds(polygon)) seen[k].emplace_back(f, polygon);
  }
  std::vector<OpeningContent> contents;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::vector<std::size_t> alike;  // from the nearest, itself
    for (std::size_t other = 0; other < shapes.size(); ++other)
      if (shapes[k].is_alike(shapes[other])) alike.push_back(other);
    std::stable_sort(alike.begin(), alike.end(), [&](std::size_t a, std::size_t b) {
      return (shapes[a].centre() - shapes[k].centre()).norm() <
             (shapes[b].centre() - shapes[k].centre()).norm();
    });
    std::vector<FlatPolygon> there;
    for (const auto& [face, polygon] : seen[k]) there.emplace_back(polygon);
    for (const std::size_t other : alike)
      for (const bool mirrored : {false, true}) {
        if (mirrored ? !shapes[k].is_symmetric() : other == k) continue;
        for (const auto& [face, polygon] : seen[other]) {
          const SpacePolygon copy = copied(polygon, shapes[other], shapes[k], mirrored);
          const FlatPolygon flat(copy);
          PolygonModel model = model_of(copy);
          if (!may_be_there(sight, flat, there) || !can_be_triangulated(model)) continue;
          there.push_back(flat);
          contents.push_back({face, std::move(model)});
        }
      }
  }
  return contents;
}

}  // namespace hybrid::stages
