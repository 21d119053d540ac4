#include "stages/rendering/opening_contents.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "stages/rendering/unseen_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSameSize_m = 0.04, kSameArea = 0.03;  // of one design
constexpr double kSameGlass_m = 0.03;
constexpr double kSymmetric_m = 0.03;  // between an outline and its mirror image
constexpr double kAround_m = 0.06;     // an opening, what stands in it
constexpr double kBeforeWall_m = 0.05;
constexpr double kOnGlass_m = 0.02;
constexpr double kThroughGlass_m = 0.03;  // behind it: no longer on it
constexpr double kDeepest_m = 0.5;        // behind the glass, of a frame
constexpr double kSideAcross = 0.1;       // cosine of a frame's side to its wall's normal
constexpr double kLevel_m = 0.03;         // of a frame's front, and of fronts that are alike
constexpr double kAtFrame_m = 0.05;       // from its front's border, its side
constexpr double kLeastSide_m2 = 0.05;    // to tell where it ends

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

  // How far behind the wall's face, of a polygon that stands in the opening parallel to it before the glass:
  // the front of a frame.
  std::optional<double> frame_level(const SpacePolygon& polygon) const {
    const auto [nearest, farthest] = depths(polygon);
    if (farthest - nearest > kLevel_m || nearest < kLevel_m || farthest > opening_.pane_m - kOnGlass_m)
      return {};
    return 0.5 * (nearest + farthest);
  }

  // Where a frame's side ends behind the glass that is seen on both sides of it, from a front at a level on.
  std::optional<double> side_end(const SpacePolygon& side, const SpacePolygon& front, double level_m) const {
    const auto [nearest, farthest] = depths(side);
    if (nearest > level_m + kAtFrame_m || farthest < opening_.pane_m + kThroughGlass_m ||
        farthest > opening_.pane_m + kDeepest_m ||
        std::abs(FlatPolygon(side).normal().dot(opening_.frame.plane.normal)) > kSideAcross)
      return {};
    const PolygonModel model = model_of(side);
    if (!can_be_triangulated(model) || face_area_m2(model, model.faces[0]) < kLeastSide_m2) return {};
    for (const Vec3& point : side.outer)
      if (from_border(front, opening_.frame.flat(point)) > kAtFrame_m) return {};
    return farthest;
  }

 private:
  std::pair<double, double> depths(const SpacePolygon& polygon) const {
    double nearest = std::numeric_limits<double>::max(), farthest = std::numeric_limits<double>::lowest();
    for (const Vec3& point : polygon.outer) {
      const double behind_m = -opening_.frame.plane.distance(point);
      nearest = std::min(nearest, behind_m);
      farthest = std::max(farthest, behind_m);
    }
    return {nearest, farthest};
  }

  double from_border(const SpacePolygon& polygon, const Vec2& at) const {
    const auto to = [&](const std::vector<Vec3>& ring) {
      Ring2 flat;
      for (const Vec3& point : ring) flat.push_back(opening_.frame.flat(point));
      return distance_to_border(flat, at);
    };
    double nearest = to(polygon.outer);
    for (const auto& hole : polygon.holes) nearest = std::min(nearest, to(hole));
    return nearest;
  }

  const GlazedOpening& opening_;
  double area_m2_;
  Vec2 middle_, size_;
  bool symmetric_;
};

// A polygon of an opening, and the face of the contours that it is or is a copy of.
struct Content {
  std::size_t face;
  SpacePolygon polygon;
};

// The front of a frame, and where its sides end, both behind the wall's face.
struct FrameDepth {
  double front_m, back_m;
};

template <typename Move>
SpacePolygon moved(const SpacePolygon& polygon, const Move& move, bool turned) {
  const auto ring = [&](std::vector<Vec3> points) {
    for (Vec3& point : points) point = move(point);
    if (turned) std::reverse(points.begin(), points.end());
    return points;
  };
  SpacePolygon result{ring(polygon.outer), {}};
  for (const auto& hole : polygon.holes) result.holes.push_back(ring(hole));
  return result;
}

SpacePolygon copied(const SpacePolygon& polygon, const OpeningShape& from, const OpeningShape& to,
                    bool mirrored) {
  const auto move = [&](const Vec3& point) {
    Place place = from.place(point);
    if (mirrored) place.at.x() = -place.at.x();
    return to.world(place);
  };
  return moved(polygon, move, mirrored);
}

// A frame's front, where its back is, looking the other way.
SpacePolygon back_of(const SpacePolygon& front, const OpeningShape& opening, double depth_m) {
  return moved(
      front,
      [&](const Vec3& point) {
        return opening.world({opening.place(point).at, -depth_m});
      },
      true);
}

class ContentSearch {
 public:
  ContentSearch(const ScanSight& sight, const PolygonModel& contours,
                const std::vector<GlazedOpening>& openings)
      : sight_(sight), shapes_(openings.begin(), openings.end()), contents_(openings.size()) {
    for (const Face& face : contours.faces) polygons_.push_back(polygon_of(contours, face));
    for (std::size_t k = 0; k < shapes_.size(); ++k) {
      for (std::size_t f = 0; f < polygons_.size(); ++f)
        if (shapes_[k].holds(polygons_[f])) contents_[k].push_back({f, polygons_[f]});
      alike_.push_back(alike(k));
    }
    seen_ = contents_;
  }

  // What is in others of its design, or mirrored in itself.
  void copy_into(std::size_t k) {
    std::vector<FlatPolygon> there;
    for (const Content& content : contents_[k]) there.emplace_back(content.polygon);
    for (const std::size_t other : alike_[k])
      for (const bool mirrored : {false, true}) {
        if (mirrored ? !shapes_[k].is_symmetric() : other == k) continue;
        for (const auto& [face, polygon] : seen_[other])
          add(OpeningContent::Kind::alike, k, {face, copied(polygon, shapes_[other], shapes_[k], mirrored)},
              there);
      }
  }

  void add_backs_of_frames(std::size_t k) {
    std::vector<FrameDepth> frames;
    for (const std::size_t other : alike_[k])
      for (const FrameDepth& frame : frames_[other]) frames.push_back(frame);
    const std::vector<Content> contents = contents_[k];
    for (const auto& [face, polygon] : contents) {
      const auto level = shapes_[k].frame_level(polygon);
      double depth_m = 0;
      for (const FrameDepth& frame : frames)
        if (level && std::abs(frame.front_m - *level) < kLevel_m) depth_m = std::max(depth_m, frame.back_m);
      if (depth_m == 0) continue;
      const SpacePolygon back = back_of(polygon, shapes_[k], depth_m);
      std::vector<FlatPolygon> there = near(back);
      add(OpeningContent::Kind::back, k, {face, back}, there);
    }
  }

  void find_frames() {
    for (std::size_t k = 0; k < shapes_.size(); ++k) {
      std::vector<FrameDepth> frames;
      for (const Content& front : contents_[k])
        if (const auto level = shapes_[k].frame_level(front.polygon))
          for (const SpacePolygon& side : polygons_)
            if (const auto end = shapes_[k].side_end(side, front.polygon, *level))
              frames.push_back({*level, *end});
      frames_.push_back(std::move(frames));
    }
  }

  std::vector<OpeningContent> take() { return std::move(found_); }

 private:
  // Openings of the same design, from the nearest on: itself.
  std::vector<std::size_t> alike(std::size_t k) const {
    std::vector<std::size_t> openings;
    for (std::size_t other = 0; other < shapes_.size(); ++other)
      if (shapes_[k].is_alike(shapes_[other])) openings.push_back(other);
    std::stable_sort(openings.begin(), openings.end(), [&](std::size_t a, std::size_t b) {
      return (shapes_[a].centre() - shapes_[k].centre()).norm() <
             (shapes_[b].centre() - shapes_[k].centre()).norm();
    });
    return openings;
  }

  // Polygons of the contours, and those found, that may cover a part of one.
  std::vector<FlatPolygon> near(const SpacePolygon& polygon) const {
    const PolygonBox box(polygon);
    std::vector<FlatPolygon> others;
    const auto take = [&](const SpacePolygon& other) {
      if (box.is_near(PolygonBox(other), kAround_m)) others.emplace_back(other);
    };
    for (const SpacePolygon& other : polygons_) take(other);
    for (const OpeningContent& other : found_) take(polygon_of(other.polygon, other.polygon.faces[0]));
    return others;
  }

  void add(OpeningContent::Kind kind, std::size_t k, Content content, std::vector<FlatPolygon>& there) {
    const FlatPolygon flat(content.polygon);
    PolygonModel model = model_of(content.polygon);
    if (!may_be_there(sight_, flat, there) || !can_be_triangulated(model)) return;
    there.push_back(flat);
    found_.push_back({kind, content.face, std::move(model)});
    contents_[k].push_back(std::move(content));
  }

  const ScanSight& sight_;
  std::vector<OpeningShape> shapes_;
  std::vector<SpacePolygon> polygons_;                 // of the contours
  std::vector<std::vector<Content>> seen_, contents_;  // per opening, without and with what was found
  std::vector<std::vector<std::size_t>> alike_;
  std::vector<std::vector<FrameDepth>> frames_;
  std::vector<OpeningContent> found_;
};

}  // namespace

std::vector<OpeningContent> opening_contents(const ScanSight& sight, const PolygonModel& contours,
                                             const std::vector<GlazedOpening>& openings) {
  ContentSearch search(sight, contours, openings);
  for (std::size_t k = 0; k < openings.size(); ++k) search.copy_into(k);
  search.find_frames();
  for (std::size_t k = 0; k < openings.size(); ++k) search.add_backs_of_frames(k);
  return search.take();
}

}  // namespace hybrid::stages
