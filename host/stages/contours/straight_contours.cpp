#include "stages/contours/straight_contours.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.hpp"
#include "stages/contours/simple_rings.hpp"

namespace hybrid::stages {
namespace {

constexpr std::int64_t kApart_nm = 10;    // what moved contours keep from each other
constexpr double kReach = 2;              // spacings from a point to its line, and beyond the line's ends
constexpr double kCornerReach = 4;        // spacings from the ends of two runs to the corner of their lines
constexpr double kLeastCornerSine = 0.2;  // lines that meet at less than 12 degrees have no sharp corner
constexpr double kGapReach = 3;
constexpr std::size_t kMostGap = 3;  // points off the line inside a run, and between the runs of a corner
constexpr double kLeastArea = 0.9, kMostArea = 2;  // of a ring, against what it had
constexpr int kFree = -1;

struct Segment {
  Vec3 from, direction;
  double length;

  double along(const Vec3& p) const { return direction.dot(p - from); }
  Vec3 foot(const Vec3& p) const { return from + along(p) * direction; }
};

// Consecutive points of a ring on one segment (kFree: on none), by their indices modulo the ring's size.
struct StraightRun {
  std::size_t first, last;
  int segment;
};

class Straightener {
 public:
  Straightener(const RangeImage& image, const Plane& plane, std::vector<Segment> segments)
      : plane_(plane),
        segments_(std::move(segments)),
        step_rad_(std::max(std::abs(image.elevation_step_rad()), std::abs(image.azimuth_step_rad()))) {}

  std::vector<Vec3> straighten(const std::vector<Vec3>& ring) const {
    const std::vector<StraightRun> runs = runs_of(ring);
    std::vector<Vec3> result;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const StraightRun& run = runs[k];
      if (run.segment == kFree) {
        for (std::size_t i = run.first; i <= run.last; ++i) result.push_back(ring[i % ring.size()]);
        continue;
      }
      const auto before = corner(ring, runs, k + runs.size() - 1), after = corner(ring, runs, k);
      const Segment& line = segments_[static_cast<std::size_t>(run.segment)];
      // A corner belongs to the run that ends there.
      if (!before) result.push_back(line.foot(ring[run.first % ring.size()]));
      result.push_back(after ? *after : line.foot(ring[run.last % ring.size()]));
    }
    return result;
  }

 private:
  double spacing_m(const Vec3& point) const {
    const double range = point.norm();
    return step_rad_ * range / std::max(std::abs(plane_.normal.dot(point)) / range, 0.1);
  }

  int nearest_segment(const Vec3& point) const {
    double least = kReach * spacing_m(point);
    const double beyond = least;
    int best = kFree;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const double along = segments_[i].along(point), distance = (segments_[i].foot(point) - point).norm();
      if (along < -beyond || along > segments_[i].length + beyond || distance > least) continue;
      least = distance;
      best = static_cast<int>(i);
    }
    return best;
  }

  // Runs of a ring, gaps inside them bridged; the first begins where a run begins.
  std::vector<StraightRun> runs_of(const std::vector<Vec3>& ring) const {
    const std::size_t n = ring.size();
    std::vector<int> on;
    for (const Vec3& point : ring) on.push_back(nearest_segment(point));
    std::size_t start = 0;
    while (start < n && on[start] == on[(start + n - 1) % n]) ++start;
    std::vector<StraightRun> runs;
    for (std::size_t i = start; i < start + n; ++i) {
      if (!runs.empty() && runs.back().segment == on[i % n])
        runs.back().last = i;
      else
        runs.push_back({i, i, on[i % n]});
      // Back on the line of the run before a short gap.
      const std::size_t k = runs.size();
      if (k >= 3 && runs[k - 1].segment != kFree && runs[k - 3].segment == runs[k - 1].segment &&
          runs[k - 2].last - runs[k - 2].first < kMostGap && stays_near(ring, runs[k - 2], on[i % n])) {
        runs[k - 3].last = i;
        runs.resize(k - 2);
      }
    }
    std::vector<StraightRun> trimmed;
    for (const StraightRun& run : runs) append_trimmed(ring, run, trimmed);
    return trimmed;
  }

  bool stays_near(const std::vector<Vec3>& ring, const StraightRun& gap, int segment) const {
    const Segment& line = segments_[static_cast<std::size_t>(segment)];
    for (std::size_t i = gap.first; i <= gap.last; ++i) {
      const Vec3& point = ring[i % ring.size()];
      if ((line.foot(point) - point).norm() > kGapReach * spacing_m(point)) return false;
    }
    return true;
  }

  // A run ends where it is farthest along its line: beyond that, the contour turns back beside it. One
  // shorter than the spacing of its samples has no direction.
  void append_trimmed(const std::vector<Vec3>& ring, const StraightRun& run,
                      std::vector<StraightRun>& runs) const {
    const std::size_t n = ring.size();
    if (run.segment == kFree) return runs.push_back(run);
    const Segment& line = segments_[static_cast<std::size_t>(run.segment)];
    const auto along = [&](std::size_t i) { return line.along(ring[i % n]); };
    std::size_t low = run.first, high = run.first;
    for (std::size_t i = run.first; i <= run.last; ++i) {
      if (along(i) < along(low)) low = i;
      if (along(i) > along(high)) high = i;
    }
    const std::size_t from = std::min(low, high), to = std::max(low, high);
    if (along(high) - along(low) < spacing_m(ring[from % n]))
      return runs.push_back({run.first, run.last, kFree});
    if (from > run.first) runs.push_back({run.first, from - 1, kFree});
    runs.push_back({from, to, run.segment});
    if (to < run.last) runs.push_back({to + 1, run.last, kFree});
  }

  // Where run k and the next one meet: the corner of three planes, if it is near both. A gap between the two
  // is left as it is.
  std::optional<Vec3> corner(const std::vector<Vec3>& ring, const std::vector<StraightRun>& runs,
                             std::size_t k) const {
    const StraightRun &one = runs[k % runs.size()], &next = runs[(k + 1) % runs.size()];
    if (one.segment == kFree || next.segment == kFree || one.segment == next.segment) return std::nullopt;
    const auto met = meet(segments_[static_cast<std::size_t>(one.segment)],
                          segments_[static_cast<std::size_t>(next.segment)]);
    if (!met) return std::nullopt;
    for (const Vec3& end : {ring[one.last % ring.size()], ring[next.first % ring.size()]})
      if ((*met - end).norm() > kCornerReach * spacing_m(end)) return std::nullopt;
    return met;
  }

  // Both lie on the plane.
  std::optional<Vec3> meet(const Segment& a, const Segment& b) const {
    const Vec3 across = plane_.normal.cross(b.direction);
    const double sine = across.dot(a.direction);
    if (std::abs(sine) < kLeastCornerSine) return std::nullopt;
    return a.from + across.dot(b.from - a.from) / sine * a.direction;
  }

  Plane plane_;
  std::vector<Segment> segments_;
  double step_rad_;
};

FlatRing flat(const PlaneCoordinates& coordinates, const ContourRing& ring) {
  FlatRing result{{}, ring.outer};
  for (const Vec3& point : ring.points) result.vertices.push_back(coordinates.vertex(point));
  return result;
}

// Rings stay as they are that would cross or touch, themselves or each other, or close up: parts a few
// samples wide may have both borders within reach of one line.
void straighten(const Straightener& straightener, Supercluster& supercluster) {
  const PlaneCoordinates coordinates(supercluster.plane);
  std::vector<ContourRing> contours;
  std::vector<FlatRing> rings;
  std::vector<bool> moved;
  for (const ContourRing& contour : supercluster.contours) {
    ContourRing straight{straightener.straighten(contour.points), contour.outer};
    FlatRing before = flat(coordinates, contour), after = flat(coordinates, straight);
    const double change = after.vertices.size() < 3 ? 0 : signed_area2(after) / signed_area2(before);
    moved.push_back(change > kLeastArea && change < kMostArea && touching_rings({after}, kApart_nm).empty());
    contours.push_back(moved.back() ? std::move(straight) : contour);
    rings.push_back(moved.back() ? std::move(after) : std::move(before));
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::size_t r : touching_rings(rings, kApart_nm)) {
      if (!moved[r]) continue;
      moved[r] = false;
      changed = true;
      contours[r] = supercluster.contours[r];
      rings[r] = flat(coordinates, contours[r]);
    }
  }
  supercluster.contours = std::move(contours);
}

}  // namespace

void straighten_contours(const RangeImage& image, const std::vector<Intersection>& intersections,
                         PlaneSegmentation& segmentation) {
  std::vector<std::vector<Segment>> of_plane(segmentation.superclusters.size() + 1);
  for (const Intersection& line : intersections) {
    const double length = (line.to - line.from).norm();
    for (const std::uint32_t id : line.planes)
      of_plane[id].push_back({line.from, (line.to - line.from) / length, length});
  }
  parallel_for(segmentation.superclusters.size(), [&](std::size_t i) {
    Supercluster& supercluster = segmentation.superclusters[i];
    if (of_plane[i + 1].empty()) return;
    straighten({image, supercluster.plane, of_plane[i + 1]}, supercluster);
  });
}

}  // namespace hybrid::stages
