#include "stages/contours/intersections.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr int kDepth = 2;  // nodes

// Two samples of two planes, next to each other.
struct Pair {
  std::uint32_t planes[2];
  std::uint32_t samples[2];
  int steps;  // nodes from the one to the other
};

std::vector<Pair> neighbouring_samples(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                                       int reach) {
  std::vector<std::vector<Pair>> of_row(static_cast<std::size_t>(image.rows));
  // 0 outside the image and where nothing was measured.
  const auto label_at = [&](int row, int col) -> std::uint32_t {
    col = image.wrapped(col);
    if (row < 0 || row >= image.rows || col < 0 || col >= image.cols) return 0;
    const std::size_t i = image.index(row, col);
    return image.mask[i] == kMeasured ? labels[i] : 0;
  };
  parallel_for(of_row.size(), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int col = 0; col < image.cols; ++col) {
      const std::uint32_t label = label_at(row, col);
      if (label == 0) continue;
      // The first sample of a plane to the right, and below. Where the line of two planes runs on over the
      // one, a few of its samples lie on the other as well: behind the samples of a pair lie more of their
      // planes.
      for (const auto& [down, right] : {std::pair(0, 1), std::pair(1, 0)}) {
        if (label_at(row + down, col + right) == label) continue;  // as most are
        if (label_at(row - kDepth * down, col - kDepth * right) != label) continue;
        for (int step = 1; step <= reach; ++step) {
          const int to_row = row + step * down, to_col = col + step * right;
          const std::uint32_t other = label_at(to_row, to_col);
          if (other == 0) continue;
          if (other != label && label_at(to_row + kDepth * down, to_col + kDepth * right) == other) {
            const auto a = static_cast<std::uint32_t>(image.index(row, col)),
                       b = static_cast<std::uint32_t>(
                           image.index(to_row, image.wraps ? to_col % image.cols : to_col));
            of_row[r].push_back(other > label ? Pair{{label, other}, {a, b}, step}
                                              : Pair{{other, label}, {b, a}, step});
          }
          break;
        }
      }
    }
  });
  std::vector<Pair> pairs;
  for (const auto& row : of_row) pairs.insert(pairs.end(), row.begin(), row.end());
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.planes[0], a.planes[1]) < std::tie(b.planes[0], b.planes[1]);
  });
  return pairs;
}

struct Line {
  Vec3 point, direction;

  double along(const Vec3& x) const { return direction.dot(x - point); }
  double distance(const Vec3& x) const { return (x - point - along(x) * direction).norm(); }
};

// Through the point of the line that is nearest to `near`.
Line line_of(const Plane& a, const Plane& b, const Vec3& near) {
  const Vec3 direction = a.normal.cross(b.normal).normalized();
  Mat3 matrix;
  matrix << a.normal.transpose(), b.normal.transpose(), direction.transpose();
  return {matrix.inverse() * Vec3(a.offset_m, b.offset_m, direction.dot(near)), direction};
}

// Between samples of the plane around this one, metres; grazing rays count up to a tenth.
double spacing_m(const Plane& plane, const Vec3& sample, double step_rad) {
  const double range = sample.norm();
  return step_rad * range / std::max(std::abs(plane.normal.dot(sample)) / range, 0.1);
}

// Where along the line a pair of samples of the two planes lies.
struct Evidence {
  double a, b, spacing;
  double in_front_m;  // how far each lies in front of the other's plane

  double middle() const { return (a + b) / 2; }
};

class PairOfPlanes {
 public:
  PairOfPlanes(const RangeImage& image, const Supercluster& a, const Supercluster& b,
               const IntersectionOptions& options)
      : image_(image),
        a_(a),
        b_(b),
        options_(options),
        step_rad_(std::max(std::abs(image.elevation_step_rad()), std::abs(image.azimuth_step_rad()))) {}

  bool is_sharp() const {
    const double least = std::cos(options_.least_angle_deg * std::numbers::pi / 180);
    return std::abs(a_.plane.normal.dot(b_.plane.normal)) < least;
  }

  void find(const Pair* begin, const Pair* end, std::vector<Intersection>& found) const {
    const Line line = line_of(a_.plane, b_.plane, image_.point(begin->samples[0]));
    std::vector<Evidence> evidence;
    for (const Pair* pair = begin; pair != end; ++pair) {
      const Vec3 a = image_.point(pair->samples[0]), b = image_.point(pair->samples[1]);
      // The line runs between them: neither is farther from it than they are apart, on its own plane.
      const double spacing_a = spacing_m(a_.plane, a, step_rad_),
                   spacing_b = spacing_m(b_.plane, b, step_rad_);
      if (line.distance(a) > (pair->steps + 1) * spacing_a ||
          line.distance(b) > (pair->steps + 1) * spacing_b)
        continue;
      const double spacing = std::max(spacing_a, spacing_b);
      evidence.push_back(
          {line.along(a), line.along(b), spacing, a_.plane.distance(b) + b_.plane.distance(a)});
    }
    join(evidence, line, found);
  }

 private:
  void join(std::vector<Evidence>& evidence, const Line& line, std::vector<Intersection>& found) const {
    std::sort(evidence.begin(), evidence.end(), [](const Evidence& x, const Evidence& y) {
      return std::tuple(x.middle(), x.a) < std::tuple(y.middle(), y.a);
    });
    for (std::size_t first = 0, last = 0; first < evidence.size(); first = last) {
      for (last = first + 1; last < evidence.size(); ++last)
        if (evidence[last].middle() >
            evidence[last - 1].middle() + options_.most_gap * evidence[last].spacing)
          break;
      // Beside the end of the one plane lie samples of the other that have passed it.
      const auto begin = evidence.begin() + static_cast<std::ptrdiff_t>(first),
                 end = evidence.begin() + static_cast<std::ptrdiff_t>(last);
      const auto [a_from, a_to] = std::minmax_element(begin, end, [](auto& x, auto& y) { return x.a < y.a; });
      const auto [b_from, b_to] = std::minmax_element(begin, end, [](auto& x, auto& y) { return x.b < y.b; });
      const double from = std::max(a_from->a, b_from->b), to = std::min(a_to->a, b_to->b);
      const auto samples = static_cast<std::int64_t>(last - first);
      if (samples < options_.least_samples || !(to > from)) continue;
      double in_front_m = 0;
      for (auto at = begin; at != end; ++at) in_front_m += at->in_front_m;
      found.push_back({{a_.id, b_.id},
                       line.point + from * line.direction,
                       line.point + to * line.direction,
                       angle_deg(in_front_m > 0),
                       samples});
    }
  }

  // Normals point to the scanner: in a corner each plane's samples lie in front of the other.
  double angle_deg(bool corner) const {
    const double between =
        std::acos(std::clamp(a_.plane.normal.dot(b_.plane.normal), -1.0, 1.0)) * 180 / std::numbers::pi;
    return corner ? 180 - between : 180 + between;
  }

  const RangeImage& image_;
  const Supercluster &a_, &b_;
  const IntersectionOptions& options_;
  double step_rad_;
};

}  // namespace

std::vector<Intersection> find_intersections(const RangeImage& image, const PlaneSegmentation& segmentation,
                                             const IntersectionOptions& options) {
  const auto pairs = neighbouring_samples(image, segmentation.sample_label, options.reach);
  std::vector<Intersection> found;
  for (std::size_t first = 0; first < pairs.size();) {
    std::size_t last = first;
    while (last < pairs.size() && pairs[last].planes[0] == pairs[first].planes[0] &&
           pairs[last].planes[1] == pairs[first].planes[1])
      ++last;
    const PairOfPlanes planes(image, segmentation.superclusters[pairs[first].planes[0] - 1],
                              segmentation.superclusters[pairs[first].planes[1] - 1], options);
    if (planes.is_sharp()) planes.find(&pairs[first], &pairs[0] + last, found);
    first = last;
  }
  return found;
}

}  // namespace hybrid::stages
