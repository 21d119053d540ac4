#include "stages/registration/automatic_offsets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr double kPeakWidth_m = 0.2;
constexpr std::size_t kPeaks = 20, kLargestTiles = 80;
constexpr double kPeakShare = 0.02;  // of the highest peak of its axis
constexpr double kNear_m = 0.3;

struct Vote {
  double offset;  // along the model plane's normal
  double area;
};

// Votes along one direction and its opposite, in coordinates of the first.
struct Axis {
  Vec3 direction;
  double area = 0;
  std::vector<Vote> votes;
};

std::vector<Axis> collect_axes(const ScanEvidence& scan, const ModelShapes& model, const Mat3& linear,
                               double scale) {
  std::vector<Axis> axes;
  const double along = std::cos(kAlongDeg * kDegree);
  for (const ScanPlane& plane : scan.planes)
    for (const ModelPlane& face : model.planes) {
      if (face.plane.normal.dot(linear * plane.plane.normal) < scale * along) continue;
      const double offset = face.plane.offset_m - face.plane.normal.dot(linear * plane.centroid);
      const double area = std::min(plane.area_m2 * scale * scale, face.area_m2);
      auto axis = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) {
        return std::abs(a.direction.dot(face.plane.normal)) > along;
      });
      if (axis == axes.end()) axis = axes.insert(axis, {face.plane.normal, 0, {}});
      const double sign = axis->direction.dot(face.plane.normal) > 0 ? 1 : -1;
      axis->votes.push_back({sign * offset, area});
      axis->area += area;
    }
  return axes;
}

// Offsets with the most area within a window, highest first, no two within a window.
std::vector<double> peaks(std::vector<Vote> votes) {
  std::stable_sort(votes.begin(), votes.end(),
                   [](const Vote& a, const Vote& b) { return a.offset < b.offset; });
  std::vector<Vote> means;  // of the window that begins at each vote
  for (std::size_t k = 0; k < votes.size(); ++k) {
    Vote sum{0, 0};
    for (std::size_t l = k; l < votes.size() && votes[l].offset < votes[k].offset + kPeakWidth_m; ++l) {
      sum.offset += votes[l].area * votes[l].offset;
      sum.area += votes[l].area;
    }
    means.push_back({sum.offset / sum.area, sum.area});
  }
  std::stable_sort(means.begin(), means.end(), [](const Vote& a, const Vote& b) { return a.area > b.area; });
  std::vector<double> found;
  for (const Vote& mean : means) {
    if (found.size() == kPeaks || mean.area < kPeakShare * means.front().area) break;
    const bool known = std::any_of(found.begin(), found.end(), [&](double other) {
      return std::abs(other - mean.offset) < kPeakWidth_m / 2;
    });
    if (!known) found.push_back(mean.offset);
  }
  return found;
}

// The three axes with the most area whose directions span the space.
std::vector<const Axis*> independent_axes(std::vector<Axis>& axes) {
  std::stable_sort(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) { return a.area > b.area; });
  std::vector<const Axis*> chosen;
  for (const Axis& axis : axes) {
    double rest = 1;
    if (chosen.size() == 1) rest = axis.direction.cross(chosen[0]->direction).norm();
    if (chosen.size() == 2)
      rest = std::abs(axis.direction.dot(chosen[0]->direction.cross(chosen[1]->direction)));
    if (rest > 0.3) chosen.push_back(&axis);
    if (chosen.size() == 3) break;
  }
  return chosen;
}

// Offsets along the three axes, from and to.
struct OffsetRange {
  Vec3 from, to;
};

// A coordinate that grows with the offsets, and where it is to be.
struct Reach {
  Vec3 slope;
  double base, low, high;
  bool is_met(const OffsetRange& offsets) const {
    constexpr double kRounding_m = 1e-6;
    const Vec3 a = slope.cwiseProduct(offsets.from), b = slope.cwiseProduct(offsets.to);
    return base + a.cwiseMin(b).sum() <= high + kRounding_m &&
           base + a.cwiseMax(b).sum() >= low - kRounding_m;
  }
};

// A tile beside a face whose normal it could have, but for the translation.
struct Candidate {
  const FaceShape* face;
  Vec3 normal;    // the face's
  Vec3 centroid;  // turned, not moved
  double height;  // over the face without translation
  double area;
  std::size_t tile;
  std::array<Reach, 3> near;  // over the face and within its box, give or take kNear_m
};

// `translation`: of offsets.
std::vector<Candidate> candidates_of(const ScanEvidence& scan, const ModelShapes& model, const Mat3& linear,
                                     double scale, const Mat3& translation) {
  std::vector<std::size_t> order(scan.tiles.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return scan.tiles[a].area_m2 > scan.tiles[b].area_m2;
  });
  if (order.size() > kLargestTiles) order.resize(kLargestTiles);
  std::vector<Candidate> found;
  const double along = scale * std::cos(kAlongDeg * kDegree);
  for (const std::size_t t : order)
    for (const FaceShape& face : model.faces) {
      const Vec3& normal = face.plane.normal;
      if (!(normal.dot(linear * scan.tiles[t].normal) > along)) continue;
      const Vec3 centroid = linear * scan.tiles[t].centroid, beside = centroid - face.origin;
      const double height = face.plane.distance(centroid);
      const auto reach = [&](const Vec3& direction, double base, double low, double high) {
        return Reach{translation.transpose() * direction, base, low - kNear_m, high + kNear_m};
      };
      found.push_back({&face,
                       normal,
                       centroid,
                       height,
                       scan.tiles[t].area_m2,
                       t,
                       {reach(normal, height, 0, 0),
                        reach(face.u, face.u.dot(beside), face.box.min().x(), face.box.max().x()),
                        reach(face.v, face.v.dot(beside), face.box.min().y(), face.box.max().y())}});
    }
  return found;
}

// Some of the candidates, in their order.
struct Likely {
  struct One {
    const Candidate* candidate;
    double rest = 0;  // area of this tile and of those after it
  };
  std::vector<One> all;

  explicit Likely(const std::vector<Candidate>& candidates) {
    for (const Candidate& c : candidates) all.push_back({&c});
    sum_rests();
  }
  // Those of them that some of these offsets bring near their face.
  Likely(const Likely& of, const OffsetRange& offsets) {
    for (const One& one : of.all) {
      const auto& near = one.candidate->near;
      if (std::all_of(near.begin(), near.end(), [&](const Reach& reach) { return reach.is_met(offsets); }))
        all.push_back(one);
    }
    sum_rests();
  }

 private:
  void sum_rests() {
    double rest = 0;
    for (std::size_t k = all.size(); k-- > 0;) {
      const bool same = k + 1 < all.size() && all[k + 1].candidate->tile == all[k].candidate->tile;
      if (!same) rest += all[k].candidate->area;
      all[k].rest = rest;
    }
  }
};

// The scores of the best guesses so far, as many as are wanted.
class BestScores {
 public:
  explicit BestScores(std::size_t most) : most_(most) {}
  // Less than this is not among them.
  double least() const { return scores_.size() < most_ ? 0 : scores_.top(); }
  void add(double score) {
    scores_.push(score);
    if (scores_.size() > most_) scores_.pop();
  }

 private:
  std::size_t most_;
  std::priority_queue<double, std::vector<double>, std::greater<>> scores_;
};

// The area of the tiles near a face; where it cannot reach `least` something below.
double near_area(const Likely& likely, const Vec3& translation, double least) {
  constexpr double kRoundedDown = 1 - 1e-9;
  double area = 0;
  std::size_t counted = static_cast<std::size_t>(-1);
  for (const auto& [candidate, rest] : likely.all) {
    const Candidate& c = *candidate;
    if (c.tile == counted) continue;
    if (area + rest < kRoundedDown * least) return 0;
    if (std::abs(c.height + c.normal.dot(translation)) > kNear_m) continue;
    if (c.face->outside_m(c.centroid + translation, kNear_m) > kNear_m) continue;
    area += c.area;
    counted = c.tile;
  }
  return area;
}

}  // namespace

std::vector<PoseGuess> guess_offsets(const ScanEvidence& scan, const ModelShapes& model,
                                     const Eigen::Quaterniond& rotation, double scale, std::size_t most) {
  const Mat3 linear = scale * rotation.toRotationMatrix();
  auto axes = collect_axes(scan, model, linear, scale);
  const auto chosen = independent_axes(axes);
  std::vector<PoseGuess> guesses;
  if (chosen.size() < 3) return guesses;
  Mat3 directions;
  std::vector<double> offsets[3];
  for (int k = 0; k < 3; ++k) {
    directions.row(k) = chosen[static_cast<std::size_t>(k)]->direction;
    offsets[k] = peaks(chosen[static_cast<std::size_t>(k)]->votes);
  }
  const Mat3 inverse = directions.inverse();
  const auto candidates = candidates_of(scan, model, linear, scale, inverse);
  const Likely all(candidates);
  OffsetRange range;
  for (int k = 0; k < 3; ++k) {
    const auto [least, most_m] = std::minmax_element(offsets[k].begin(), offsets[k].end());
    range.from(k) = *least;
    range.to(k) = *most_m;
  }
  BestScores best(most);
  for (const double a : offsets[0]) {
    OffsetRange at = range;
    at.from.x() = at.to.x() = a;
    const Likely at_a(all, at);
    for (const double b : offsets[1]) {
      at.from.y() = at.to.y() = b;
      const Likely at_b(at_a, at);
      for (const double c : offsets[2]) {
        const Vec3 translation = inverse * Vec3(a, b, c);
        const double area = near_area(at_b, translation, best.least());
        if (area <= 0) continue;
        guesses.push_back({{scale, rotation, translation}, area});
        best.add(area);
      }
    }
  }
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const PoseGuess& a, const PoseGuess& b) { return a.score > b.score; });
  if (guesses.size() > most) guesses.resize(most);
  return guesses;
}

bool same_place(const ScanEvidence& scan, const Pose& a, const Pose& b, double distance_m) {
  // Six points about the scanner at the samples' distance stand for the scan.
  double sum = 0;
  for (int k = 0; k < 6; ++k) {
    const Vec3 p = scan.reach_m * (k % 2 ? -1.0 : 1.0) * Vec3::Unit(k / 2);
    sum += (a * p - b * p).squaredNorm() / 6;
  }
  return std::sqrt(sum) < distance_m;
}

}  // namespace hybrid::stages
