#include "stages/planes/cylinder_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/parallel.hpp"
#include "geometry/angles.hpp"
#include "stages/planes/cylinder_fit.hpp"
#include "stages/planes/cylinders.hpp"
#include "stages/planes/plane_regions.hpp"
#include "stages/planes/square_contact.hpp"
#include "stages/scan/node_lookup.hpp"

namespace hybrid::stages {
namespace {

// Squares about the first, until a cylinder shows itself; a vault is wide and its squares are many.
constexpr std::array<int, 3> kRings = {2, 4, 8};
constexpr std::array<int, 2> kRingsInside = {8, 16};
constexpr double kMostTurnToNext = 50 * kDegree;  // of a square to the next
constexpr double kMostNormalLean =
    15 * kDegree;                     // of a square's normal from the cylinder's, beyond its noise
constexpr double kRoughReach = 0.08;  // of the radius, at most of kSmall_m: squares from the first guess
constexpr double kSmall_m = 1;
constexpr double kLeastAgree = 0.6;  // of the squares that suggested it
constexpr double kMostRadius_m = 3, kMostRadiusInside_m = 15;
constexpr double kSmooth = 0.02;            // of the radius: squares' centroids from a fitted one
constexpr std::size_t kMostFitted = 4000;   // samples
constexpr std::size_t kMostSquares = 1000;  // that are fitted
constexpr double kFarOff_m = 1;             // is beyond any reach
constexpr int kGrowths = 3;
constexpr double kMostGap = 1.0;  // of its length: how far the same cylinder goes on beyond what hides it
constexpr double kThinBin = 0.3;  // of the median: a slice with fewer samples is beyond an end
constexpr std::size_t kThinArc = 100;  // of the mean: a sector with fewer samples is beyond an end
constexpr double kLeastArc = 70 * kDegree, kMostArc = 220 * kDegree;  // half of it is what one scanner sees
constexpr double kMostTaper = 0.06;
constexpr double kStandsOut = 8;  // times the rms: least height of the arc over its chord
constexpr double kLeastLength = 1.5, kLeastLengthInside = 0.15;  // radii; the least is an arch
constexpr double kMostSigma = 0.03;                              // of the radius
constexpr double kMostBow = 0.005;  // of its length: how far the axis may leave its chord
constexpr double kMiddle = 0.8;     // of its length, where mouldings at its ends do not reach
constexpr double kMostSeenThrough = 0.05, kLeastSeen = 0.4;
constexpr double kLimb = 0.35;              // cosine: rays nearer to the limb say nothing
constexpr int kSlices = 64, kSectors = 48;  // where it is asked whether it is seen
constexpr double kLeastAsked = 0.05;        // of them: what all rays graze is not told by any

using Nodes = std::vector<std::uint32_t>;

class Search {
 public:
  // `inside`: of vaults, seen from inside, else of columns and pipes.
  Search(const RangeImage& image, Facets facets, const std::vector<std::uint32_t>& labels,
         const SuperclusterOptions& options, bool inside)
      : inside_(inside),
        rings_(inside ? std::vector<int>(kRingsInside.begin(), kRingsInside.end())
                      : std::vector<int>(kRings.begin(), kRings.end())),
        most_radius_m_(inside ? kMostRadiusInside_m : kMostRadius_m),
        image_(image),
        squares_(facets.planes),
        height_(facets.height),
        width_(facets.width),
        labels_(labels),
        options_(options),
        grid_(image, facets.planes),
        lookup_(image),
        free_(std::move(facets.free)),
        seen_(grid_.count()),
        visited_(inside ? 0 : image.count()),
        least_cosine_(grid_.count()) {
    for (std::uint32_t i = 0; i < free_.size(); ++i) {
      if (!free_[i]) continue;
      all_free_.push_back(i);
      const double lean =
          kMostNormalLean + options.angle_sigmas * static_cast<double>(square(i).sigma_normal);
      least_cosine_[i] = std::cos(std::min(lean, std::numbers::pi / 2));
    }
  }

  std::vector<Cylinder> all() {
    std::vector<Cylinder> found;
    std::vector<std::uint8_t> tried(grid_.count());
    for (const std::uint32_t seed : all_free_) {
      if (!free_[seed] || tried[seed] || !may_bulge(seed)) continue;
      tried[seed] = 1;
      Nodes members;
      const auto rough = rough_at(seed, members);
      for (const std::uint32_t square : members) tried[square] = 1;
      if (!rough) continue;
      if (const auto cylinder = settle(*rough)) found.push_back(*cylinder);
    }
    return found;
  }

 private:
  const SquareRecord& square(std::uint32_t i) const { return squares_.squares[i]; }

  // Its normal and a neighbour's turn away from each other, or it has not all neighbours: no vault. All may
  // be of a vault, whose squares turn by less than their noise.
  bool may_bulge(std::uint32_t seed) const {
    if (inside_) return true;
    for (int direction = 0; direction < 4; ++direction) {
      const std::int64_t next = grid_.neighbour(seed, direction);
      if (next == SquareGrid::kNone || !free_[static_cast<std::size_t>(next)]) return true;
      const SquareRecord &here = square(seed), &there = square(static_cast<std::uint32_t>(next));
      const Vec3 step = square_centroid(there) - square_centroid(here);
      if (step.dot(square_normal(there) - square_normal(here)) > step.squaredNorm() / kMostRadius_m)
        return true;
    }
    return false;
  }

  // Free squares in contact within so many steps of the seed.
  Nodes around(std::uint32_t seed, int rings) {
    const ContactLimits limits{kMostTurnToNext, options_.angle_sigmas, options_.distance_factor,
                               options_.offset_sigmas};
    Nodes reached = {seed};
    seen_[seed] = 1;
    std::size_t from = 0;
    for (int ring = 0; ring < rings; ++ring)
      for (const std::size_t to = reached.size(); from < to; ++from)
        for (int direction = 0; direction < 4; ++direction) {
          const std::int64_t next = grid_.neighbour(reached[from], direction);
          if (next == SquareGrid::kNone) continue;
          const auto other = static_cast<std::uint32_t>(next);
          if (!free_[other] || seen_[other] ||
              !in_contact(image_, squares_, limits, square(reached[from]), square(other)))
            continue;
          seen_[other] = 1;
          reached.push_back(other);
        }
    for (const std::uint32_t i : reached) seen_[i] = 0;
    return reached;
  }

  static Nodes some(const Nodes& all) {
    const std::size_t stride = 1 + all.size() / kMostSquares;
    Nodes few;
    for (std::size_t k = 0; k < all.size(); k += stride) few.push_back(all[k]);
    return few;
  }

  std::vector<OrientedPoint> oriented(const Nodes& members) const {
    std::vector<OrientedPoint> points;
    for (const std::uint32_t i : members)
      points.push_back({square_centroid(square(i)), square_normal(square(i))});
    return points;
  }

  bool agrees(const Cylinder& cylinder, std::uint32_t i, double rough) const {
    const Vec3 centroid = square_centroid(square(i)), normal = square_normal(square(i));
    const Vec3 out = cylinder.outwards(centroid);
    return std::abs(cylinder.distance(centroid)) <=
               rough * std::min(cylinder.radius_m, kSmall_m) + options_.label_sigmas * squares_.sigma_m &&
           (inside_ ? -1 : 1) * out.dot(normal) >= least_cosine_[i] * out.norm();
  }

  // What the squares around the seed suggest, followed from square to square while it goes on.
  std::optional<Cylinder> rough_at(std::uint32_t seed, Nodes& members) {
    for (const int rings : rings_) {
      Nodes near = around(seed, rings);
      if (inside_) members = near;  // which need not be asked again
      auto guess = cylinder_through(oriented(near));
      if (!is_sought(guess)) continue;
      const std::size_t asked = near.size();
      std::erase_if(near, [&](std::uint32_t i) { return !agrees(*guess, i, kRoughReach); });
      if (static_cast<double>(near.size()) < kLeastAgree * static_cast<double>(asked)) continue;
      members = near;
      for (int growth = 0; growth < kGrowths; ++growth) {
        members = followed(*guess, members);
        const auto better = cylinder_through(oriented(some(members)));
        if (!is_sought(better)) break;
        guess = better;
      }
      std::vector<Vec3> centroids;
      for (const std::uint32_t i : some(members)) centroids.push_back(square_centroid(square(i)));
      if (auto fitted = fit_cylinder(centroids, *guess, reach_of_squares(*guess))) return fitted;
    }
    return std::nullopt;
  }

  bool is_sought(const std::optional<Cylinder>& cylinder) const {
    return cylinder && cylinder->inside == inside_ && cylinder->radius_m <= most_radius_m_;
  }

  double reach_of_squares(const Cylinder& cylinder) const {
    return 2 * kRoughReach * std::min(cylinder.radius_m, kSmall_m) + options_.label_sigmas * squares_.sigma_m;
  }

  Nodes followed(const Cylinder& cylinder, const Nodes& from) {
    Nodes reached;
    for (const std::uint32_t i : from)
      if (agrees(cylinder, i, kRoughReach)) {
        reached.push_back(i);
        seen_[i] = 1;
      }
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (int direction = 0; direction < 4; ++direction) {
        const std::int64_t next = grid_.neighbour(reached[k], direction);
        if (next == SquareGrid::kNone) continue;
        const auto other = static_cast<std::uint32_t>(next);
        if (!free_[other] || seen_[other] || !agrees(cylinder, other, kRoughReach)) continue;
        seen_[other] = 1;
        reached.push_back(other);
      }
    for (const std::uint32_t i : reached) seen_[i] = 0;
    return reached;
  }

  // Row and column of a facet's k-th sample; they may lie outside the image.
  std::pair<int, int> node_of(std::uint32_t facet, int k) const {
    const int i = static_cast<int>(facet);
    return {i / grid_.cols * height_ + k / width_, i % grid_.cols * width_ + k % width_};
  }

  double reach_m(const Cylinder& cylinder, const Vec3& point) const {
    return cylinder_reach_m(cylinder, point, squares_.noise, options_);
  }

  bool on(const Cylinder& cylinder, std::uint32_t i) const {
    if (image_.mask[i] != kMeasured || labels_[i] != 0) return false;
    const Vec3 point = image_.point(i);
    const double off = std::abs(cylinder.distance(point));
    return off <= cylinder_unevenness_m(cylinder, options_) ||  // most are: the noise need not be asked for
           (off <= kFarOff_m && off <= reach_m(cylinder, point));
  }

  // Free squares on the cylinder, in whatever part of the scan, not far beyond its ends.
  Nodes agreeing(const Cylinder& cylinder, double rough) const {
    const double gap = kMostGap * cylinder.length_m;
    Nodes found;
    for (const std::uint32_t s : all_free_) {
      const double along = cylinder.along(square_centroid(square(s)));
      if (free_[s] && along >= -gap && along <= cylinder.length_m + gap && agrees(cylinder, s, rough))
        found.push_back(s);
    }
    return found;
  }

  // Samples on the cylinder that hang together with those of its squares.
  Nodes flood(const Cylinder& cylinder) {
    Nodes reached;
    const auto reach = [&](int row, int col) {
      col = image_.wrapped(col);
      if (row < 0 || col < 0 || row >= image_.rows || col >= image_.cols) return;
      const auto i = static_cast<std::uint32_t>(image_.index(row, col));
      if (visited_[i] || !on(cylinder, i)) return;
      visited_[i] = true;
      reached.push_back(i);
    };
    for (const std::uint32_t s : agreeing(cylinder, kSmooth))
      for (int k = 0; k < height_ * width_; ++k)
        if (const auto [row, col] = node_of(s, k); row < image_.rows && col < image_.cols) reach(row, col);
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const int row = static_cast<int>(reached[k]) / image_.cols,
                col = static_cast<int>(reached[k]) % image_.cols;
      reach(row, col + 1);
      reach(row + 1, col);
      reach(row, col - 1);
      reach(row - 1, col);
    }
    for (const std::uint32_t i : reached) visited_[i] = false;
    return reached;
  }

  std::optional<Cylinder> refit(const Cylinder& cylinder, const Nodes& nodes) const {
    const std::size_t stride = (nodes.size() + kMostFitted - 1) / kMostFitted;
    std::vector<Vec3> points;
    double reach = 0;
    for (std::size_t k = 0; k < nodes.size(); k += std::max<std::size_t>(stride, 1)) {
      points.push_back(image_.point(nodes[k]));
      reach += reach_m(cylinder, points.back());
    }
    if (points.empty()) return std::nullopt;
    return fit_cylinder(points, cylinder, 1.5 * reach / static_cast<double>(points.size()));
  }

  // Some of the samples of the squares that agree.
  Nodes sampled(const Cylinder& cylinder, const Nodes& members) const {
    const std::size_t each = static_cast<std::size_t>(height_) * static_cast<std::size_t>(width_);
    const std::size_t total = members.size() * each, stride = 1 + total / kMostFitted;
    Nodes nodes;
    for (std::size_t at = 0; at < total; at += stride) {
      const auto [row, col] = node_of(members[at / each], static_cast<int>(at % each));
      if (row >= image_.rows || col >= image_.cols) continue;
      const auto i = static_cast<std::uint32_t>(image_.index(row, col));
      if (on(cylinder, i)) nodes.push_back(i);
    }
    return nodes;
  }

  // Of columns the last round takes all that a flood finds, and so do the others where squares hold little.
  Nodes nodes_to_fit(const Cylinder& cylinder, int growth) {
    if (inside_) return sampled(cylinder, agreeing(cylinder, growth > 0 ? kSmooth : kRoughReach));
    if (growth + 1 == kGrowths) return flood(cylinder);
    Nodes nodes = sampled(cylinder, agreeing(cylinder, kRoughReach));
    return 2 * nodes.size() < kMostFitted ? flood(cylinder) : nodes;
  }

  std::optional<Cylinder> settle(Cylinder cylinder) {
    Nodes nodes;
    for (int growth = 0; growth < kGrowths; ++growth) {
      nodes = nodes_to_fit(cylinder, growth);
      const auto fitted = refit(cylinder, nodes);
      if (!is_sought(fitted)) return std::nullopt;
      cylinder = *fitted;
    }
    std::erase_if(nodes, [&](std::uint32_t i) { return !on(cylinder, i); });
    cut_ends(nodes, cylinder);
    cylinder.samples = inside_ ? count_on(cylinder) : std::ssize(nodes);
    const auto [from, arc] = arc_rad(cylinder, nodes);
    cylinder.arc_deg = arc / kDegree;
    const double height = cylinder.radius_m * (1 - std::cos(0.5 * std::min(arc, std::numbers::pi)));
    if (cylinder.samples < options_.min_cylinder_samples || arc < kLeastArc || (!inside_ && arc > kMostArc) ||
        height < kStandsOut * cylinder.rms_m || std::abs(cylinder.taper) > kMostTaper ||
        cylinder.length_m < (inside_ ? kLeastLengthInside : kLeastLength) * cylinder.radius_m ||
        cylinder.sigma_radius_m > kMostSigma * cylinder.radius_m ||
        bow_m(cylinder, nodes) > kMostBow * cylinder.length_m || !is_seen(cylinder, from, arc))
      return std::nullopt;
    take(cylinder, nodes);
    return cylinder;
  }

  // Ends where samples are few: mouldings touch a shaft's surface, too.
  void cut_ends(Nodes& nodes, Cylinder& cylinder) const {
    if (nodes.empty()) return;
    std::array<std::size_t, kSlices> count{};
    const auto slice = [&](std::uint32_t i) {
      const double along = cylinder.along(image_.point(i)) / std::max(cylinder.length_m, 1e-9);
      return std::clamp(static_cast<int>(along * kSlices), 0, kSlices - 1);
    };
    for (const std::uint32_t i : nodes) ++count[static_cast<std::size_t>(slice(i))];
    auto sorted = count;
    std::sort(sorted.begin(), sorted.end());
    const double least = kThinBin * static_cast<double>(sorted[kSlices / 2]);
    int first = 0, last = kSlices - 1;
    while (first < last && static_cast<double>(count[static_cast<std::size_t>(first)]) < least) ++first;
    while (last > first && static_cast<double>(count[static_cast<std::size_t>(last)]) < least) --last;
    std::erase_if(nodes, [&](std::uint32_t i) { return slice(i) < first || slice(i) > last; });
    const double slice_m = cylinder.length_m / kSlices;
    const double radius_m = cylinder.radius_at(0.5 * (first + last + 1) * slice_m);
    cylinder.foot += first * slice_m * cylinder.axis;
    cylinder.length_m = (last - first + 1) * slice_m;
    cylinder.radius_m = radius_m;
  }

  // The circumference without its widest gap: where it begins, and how much it is.
  std::pair<double, double> arc_rad(const Cylinder& cylinder, const Nodes& nodes) const {
    constexpr int kBins = 180;
    std::array<std::size_t, kBins> count{};
    const Vec3 a = cylinder.axis.unitOrthogonal(), b = cylinder.axis.cross(a);
    for (const std::uint32_t i : nodes) {
      const Vec3 out = cylinder.outwards(image_.point(i));
      const double turn = std::atan2(out.dot(b), out.dot(a)) / (2 * std::numbers::pi) + 0.5;
      ++count[static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kBins), 0, kBins - 1))];
    }
    constexpr double kBin = 2 * std::numbers::pi / kBins;
    int widest = 0, empty = 0, begin = 0;
    for (int k = 0; k < 2 * kBins; ++k) {
      empty = kThinArc * count[static_cast<std::size_t>(k % kBins)] < nodes.size() / kBins ? empty + 1 : 0;
      if (std::min(empty, kBins) <= widest) continue;
      widest = std::min(empty, kBins);
      begin = k + 1;
    }
    return {begin * kBin - std::numbers::pi, (kBins - widest) * kBin};
  }

  // By how much its axis leaves its chord: least squares of the distances by an axis that is a parabola, and
  // a radius that is one, as mouldings at a shaft's ends make it. A moulding's own roll around a column is no
  // pipe.
  double bow_m(const Cylinder& cylinder, const Nodes& nodes) const {
    const Vec3 a = cylinder.axis.unitOrthogonal(), b = cylinder.axis.cross(a);
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const std::uint32_t i : nodes) {
      const Vec3 point = image_.point(i), out = cylinder.outwards(point).normalized();
      const double t = 2 * cylinder.along(point) / cylinder.length_m - 1, bend = t * t - 1.0 / 3;
      if (std::abs(t) > kMiddle) continue;
      const Eigen::Vector4d row(bend * out.dot(a), bend * out.dot(b), bend, 1);
      matrix += row * row.transpose();
      right += cylinder.distance(point) * row;
    }
    const Eigen::Vector4d solved = matrix.ldlt().solve(right);
    return solved.allFinite() ? solved.head<2>().norm() : 0;
  }

  // Of its arc, where it faces the scanner: rays that end on it, before it, behind it.
  bool is_seen(const Cylinder& cylinder, double from_rad, double arc_rad) const {
    const Vec3 a = cylinder.axis.unitOrthogonal(), b = cylinder.axis.cross(a);
    int on_it = 0, through = 0, asked = 0;
    for (int slice = 0; slice < kSlices; ++slice)
      for (int sector = 0; sector < kSectors; ++sector) {
        const double along = (slice + 0.5) / kSlices * cylinder.length_m;
        const double turn = from_rad + arc_rad * (sector + 0.5) / kSectors;
        const Vec3 out = std::cos(turn) * a + std::sin(turn) * b;
        const Vec3 point = cylinder.foot + along * cylinder.axis + cylinder.radius_at(along) * out;
        const double cosine = (inside_ ? 1 : -1) * out.dot(point.normalized());
        if (cosine < kLimb) continue;
        const auto node = lookup_.towards(point);
        const std::size_t i = image_.index(node.row, node.col);
        if (!node.within || image_.mask[i] != kMeasured) continue;
        const double behind = (image_.point(i).norm() - point.norm()) * cosine;
        const double reach = 2 * reach_m(cylinder, point) + point.norm() * image_.step_rad();
        asked += 1;
        on_it += std::abs(behind) <= reach;
        through += behind > reach;
      }
    return asked >= kLeastAsked * kSlices * kSectors && on_it >= kLeastSeen * asked &&
           through <= kMostSeenThrough * (on_it + through);
  }

  // Of the squares that agree between its ends.
  std::int64_t count_on(const Cylinder& cylinder) const {
    const Nodes members = agreeing(cylinder, kSmooth);
    std::vector<std::int64_t> counts(members.size());
    parallel_for(members.size(), [&](std::size_t k) {
      for (int inside = 0; inside < height_ * width_; ++inside) {
        const auto [row, col] = node_of(members[k], inside);
        if (row >= image_.rows || col >= image_.cols) continue;
        const auto i = static_cast<std::uint32_t>(image_.index(row, col));
        if (!on(cylinder, i)) continue;
        const double along = cylinder.along(image_.point(i));
        counts[k] += along >= 0 && along <= cylinder.length_m;
      }
    });
    return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  }

  // No other cylinder may have its squares.
  void take(const Cylinder& cylinder, const Nodes& nodes) {
    const auto cols = static_cast<std::uint32_t>(image_.cols);
    for (const std::uint32_t i : nodes)
      free_[i / cols / static_cast<std::uint32_t>(height_) * static_cast<std::uint32_t>(grid_.cols) +
            i % cols / static_cast<std::uint32_t>(width_)] = 0;
    for (const std::uint32_t s : all_free_)
      if (free_[s] && agrees(cylinder, s, kSmooth) && cylinder.along(square_centroid(square(s))) >= 0 &&
          cylinder.along(square_centroid(square(s))) <= cylinder.length_m)
        free_[s] = 0;
  }

  bool inside_;
  std::vector<int> rings_;
  double most_radius_m_;
  const RangeImage& image_;
  const SquarePlanes& squares_;
  int height_, width_;
  const std::vector<std::uint32_t>& labels_;
  const SuperclusterOptions& options_;
  SquareGrid grid_;
  NodeLookup lookup_;
  std::vector<std::uint8_t> free_, seen_;  // per square
  std::vector<bool> visited_;              // per node; bits, for there may be hundreds of millions
  std::vector<double> least_cosine_;       // per square, between its normal and the cylinder's
  Nodes all_free_;                         // as it was in the beginning
};

}  // namespace

std::vector<Cylinder> search_cylinders(const RangeImage& image, Facets facets,
                                       const std::vector<std::uint32_t>& labels,
                                       const SuperclusterOptions& options, bool inside) {
  return Search(image, std::move(facets), labels, options, inside).all();
}

}  // namespace hybrid::stages
