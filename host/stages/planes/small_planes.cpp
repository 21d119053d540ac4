#include "stages/planes/small_planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>
#include <unordered_map>

#include "core/large_vector.hpp"
#include "core/parallel.hpp"
#include "core/parallel_uneven.hpp"
#include "stages/planes/coplanar_merge.hpp"
#include "stages/planes/flood_candidates.hpp"
#include "stages/planes/flood_shape.hpp"
#include "stages/planes/free_islands.hpp"
#include "stages/planes/plane_floods.hpp"
#include "stages/planes/plane_steps.hpp"
#include "stages/planes/sparse_seeds.hpp"
#include "stages/planes/thinned_image.hpp"
#include "stages/planes/window_seeds.hpp"

namespace hybrid::stages {
namespace {

constexpr double kNoiseFloor_m = 1e-4;    // as estimate_range_noise(): what floats and the model leave
constexpr double kMostFloodChi2 = 1.6;    // per sample
constexpr double kFoundBySquares = 0.25;  // of the samples
constexpr double kSameNormal = 0.998;     // cosine
constexpr double kFollowing = 2;          // standard deviations
constexpr double kMostBesideCurved = 0.3;
constexpr double kMostOn = 0.8;
constexpr double kMostWorse = 30;  // chi2 of the three numbers that two planes have more than one

// A flood that is a plane, and in whose place it came.
struct Found {
  FloodCandidate as;
  PlaneFlood flood;
  PlaneRegion region;
};

// Residuals of neighbours, in sigmas, have more in common than chance explains. Noise that is only larger
// than thought follows no neighbour: the sum of the products over pairs has a mean of 0 and a known variance.
bool follows_neighbours(const RangeImage& image, const RangeNoise& noise, const PlaneFlood& flood) {
  constexpr std::array<std::array<int, 2>, 6> kPairs = {{{0, 1}, {1, -1}, {1, 0}, {1, 1}, {0, 2}, {2, 0}}};
  std::unordered_map<std::uint32_t, double> residuals;
  for (const std::uint32_t i : flood.samples) {
    const Vec3 point = image.point(i);
    const double range = point.norm();
    const auto [residual_m, cosine] = flood.plane.at(point, range);
    residuals[i] = residual_m / noise.at(range, cosine);
  }
  double products = 0, pairs = 0;
  for (const auto& pair : kPairs)
    for (const std::uint32_t i : flood.samples) {
      const auto other = residuals.find(i + static_cast<std::uint32_t>(pair[0] * image.cols + pair[1]));
      if (other == residuals.end()) continue;
      products += residuals[i] * other->second;
      pairs += 1;
    }
  return products * static_cast<double>(flood.samples.size()) > kFollowing * std::sqrt(pairs) * flood.chi2;
}

// The plane through the samples of two parts; none when they show that they lie on two: the fit to both is
// worse than noise explains, by more than walls stray.
std::optional<RayPlane> joint_plane(const RangeImage& image, const RayPlane& part, const PlaneFlood& flood,
                                    double waviness_m) {
  RayPlane joint = part;
  for (const std::uint32_t i : flood.samples) joint.add(image.point(i));
  if (!joint.solve()) return std::nullopt;
  const auto count = static_cast<double>(joint.samples());
  const double apart = part.squares_m2() + flood.plane.squares_m2(), worse = joint.squares_m2() - apart;
  const double stray_m = kLeastOfWaviness * waviness_m;
  if (worse * (count - 6) > kMostWorse * apart && worse > stray_m * stray_m * count) return std::nullopt;
  return joint;
}

// Most of the flood's samples would be labelled with this plane.
bool lies_on(const RangeImage& image, const PlaneFlood& flood, const Plane& plane, const RangeNoise& noise,
             const SuperclusterOptions& options) {
  const auto on = std::count_if(flood.samples.begin(), flood.samples.end(), [&](std::uint32_t i) {
    const Vec3 point = image.point(i);
    const double range = point.norm(), cosine = std::abs(plane.normal.dot(point)) / range;
    return std::abs(plane.distance(point)) <=
           options.label_sigmas * noise.at(range, cosine) * cosine + options.waviness_m;
  });
  return static_cast<double>(on) >= kMostOn * static_cast<double>(flood.samples.size());
}

// What small planes are looked for in, and what became of it.
class SmallPlanes {
 public:
  SmallPlanes(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
              const std::vector<std::uint32_t>& labels, const SuperclusterOptions& options,
              PlaneRegions& regions, std::vector<Plane>& planes)
      : image_(image),
        squares_(squares),
        grid_(grid),
        labels_(labels),
        options_(options),
        regions_(regions),
        planes_(planes),
        thinned_(image),
        seen_(thinned_.image()),
        least_(static_cast<std::size_t>(least_plane_samples(seen_, options))),
        sigma_m_(std::max(squares.sigma_m, kNoiseFloor_m)),
        use_(free_samples()),
        flooder_(seen_, use_, squares.noise),
        islands_(seen_, use_),
        blocked_normals_(islands_.numbers()) {}

  const RangeImage& seen() const { return seen_; }
  const std::vector<std::uint8_t>& use() const { return use_; }

  // The planes of these seeds' floods, the largest first.
  void recover(const std::vector<WindowSeed>& seeds) {
    const auto groups =
        candidate_groups(seen_, use_, islands_, try_seeds(seen_, use_, squares_.noise, seeds, least_));
    std::vector<std::vector<Found>> of_group(groups.size());
    parallel_for_uneven(groups.size(), [&](std::size_t k) { of_group[k] = flood_group(groups[k]); });
    std::vector<Found> found;  // in the order of one heap
    for (auto& list : of_group) std::move(list.begin(), list.end(), std::back_inserter(found));
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return b.as < a.as; });
    for (Found& one : found) take(one);
  }

  SquarePresence presence() const {
    SquarePresence sorted = presence_;
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    return sorted;
  }

 private:
  std::uint32_t label(std::size_t i) const { return labels_[thinned_.whole_index(i)]; }

  std::vector<std::uint8_t> free_samples() const {
    std::vector<std::uint8_t> use;
    resize_large(use, seen_.count());
    parallel_for(
        use.size(),
        [&](std::size_t i) {
          if (seen_.mask[i] != kMeasured) return;
          const std::uint32_t id = label(i);
          use[i] = id == 0 ? kFree : regions_.regions[id - 1].curved ? kBlocked : kNotFree;
        },
        1 << 14);
    return use;
  }

  // The floods of one group that are planes. Groups do not see each other.
  std::vector<Found> flood_group(const std::vector<FloodCandidate>& candidates) {
    std::vector<Found> found;
    std::priority_queue<FloodCandidate> heap(candidates.begin(), candidates.end());
    while (!heap.empty()) {
      FloodCandidate best = heap.top();
      heap.pop();
      PlaneFlood flood = flooder_.flood(best.seed);
      const std::size_t size = flood.samples.size();
      if (size < least_) continue;
      const bool smaller = size < best.size;  // others took samples
      best.size = std::min(best.size, size);
      if (smaller && !heap.empty() && size < heap.top().size) {  // not its turn yet
        heap.push(best);
        continue;
      }
      PlaneRegion region;
      const SampleUse verdict = judge(flood, region);
      if (verdict == kFree) continue;
      for (const std::uint32_t i : flood.samples) use_[i] = verdict;
      if (verdict == kBlocked)
        for (const std::uint32_t i : flood.samples)
          blocked_normals_[islands_.number(i)] = region.fit.plane.normal;
      else
        found.push_back({best, std::move(flood), std::move(region)});
    }
    return found;
  }

  // What a flood becomes, without its tongues if that makes it a plane; and its region.
  SampleUse judge(PlaneFlood& flood, PlaneRegion& region) const {
    region = region_of_flood(seen_, flood);
    const SampleUse whole = judge_as_is(flood, region);
    if (whole != kBlocked) return whole;
    PlaneFlood body = flooder_.without_tongues(flood);
    if (body.samples.size() < least_ || body.samples.size() >= flood.samples.size()) return whole;
    PlaneRegion of_body = region_of_flood(seen_, body);
    if (judge_as_is(body, of_body) != kTaken) return whole;
    flood = std::move(body);
    region = std::move(of_body);
    return kTaken;
  }

  // kTaken: a plane; kBlocked: part of a curved surface; kFree: neither.
  SampleUse judge_as_is(const PlaneFlood& flood, const PlaneRegion& region) const {
    const bool scattered = flood.chi2 > kMostFloodChi2 * static_cast<double>(flood.samples.size() - 3) &&
                           !(squares_found(flood) && !follows_neighbours(seen_, squares_.noise, flood));
    const Plane plane = flood.plane.plane();
    // Floods that bend have their normals by number of the sample, regions that do by their labels.
    const auto blocked_normal = [&](std::uint32_t i) -> Vec3 {
      return label(i) != 0 ? regions_.regions[label(i) - 1].fit.plane.normal
                           : blocked_normals_[islands_.number(i)];
    };
    const auto beside_curved =
        std::count_if(flood.samples.begin(), flood.samples.end(), [&](std::uint32_t i) {
          return meets_curved_surface(seen_, use_, plane, sigma_m_, i, blocked_normal);
        });
    const auto samples = static_cast<double>(flood.samples.size());
    if (static_cast<double>(beside_curved) > kMostBesideCurved * samples ||
        is_strip_of_smooth_surface(seen_, flood, sigma_m_, kMostBesideCurved) ||
        flood_bends(seen_, flood, region, options_.min_curvature, scattered))
      return kBlocked;
    return scattered ? kFree : kTaken;
  }

  // Squares found the flood's plane on their own, too few for a supercluster.
  bool squares_found(const PlaneFlood& flood) const {
    const Plane plane = flood.plane.plane();
    const double samples = static_cast<double>(flood.samples.size()) * thinned_.stride() * thinned_.stride();
    return std::any_of(regions_.regions.begin(), regions_.regions.end(), [&](const PlaneRegion& region) {
      return region.few && region.moments.weight >= kFoundBySquares * samples &&
             region.fit.plane.normal.dot(plane.normal) >= kSameNormal &&
             std::abs(plane.distance(region.fit.centroid)) <= options_.waviness_m;
    });
  }

  // Makes a region of its own of it, or gives it to the one whose plane it continues.
  void take(Found& one) {
    const PlaneFlood& flood = one.flood;
    PlaneRegion& region = one.region;
    region.squares = squares_of(flood);
    std::uint32_t id = coplanar_region(image_, squares_, grid_, options_, regions_, region);
    std::optional<RayPlane> joint;
    if (id != 0 && regions_.regions[id - 1].small) {
      joint = joint_plane(seen_, plane_of_small_.at(id), flood, options_.waviness_m);
      if (!joint) id = 0;
    } else if (id != 0 && !lies_on(seen_, flood, planes_[id - 1], squares_.noise, options_)) {
      id = 0;  // the two agree within what their few squares say: samples will tell (rejoin_planes)
    }
    if (id == 0) {
      regions_.regions.push_back(region);
      planes_.push_back(flood.plane.plane());
      id = static_cast<std::uint32_t>(regions_.regions.size());
      plane_of_small_.emplace(id, flood.plane);
    } else if (joint) {
      PlaneRegion& continued = regions_.regions[id - 1];
      continued.squares.insert(continued.squares.end(), region.squares.begin(), region.squares.end());
      continued.moments.merge(region.moments);
      continued.fit = fit_plane(continued.moments);
      planes_[id - 1] = joint->plane();
      plane_of_small_.at(id) = *joint;
    }
    for (const std::uint32_t square : region.squares) presence_.emplace_back(square, id);
  }

  // Squares in which the flood has samples, sorted.
  std::vector<std::uint32_t> squares_of(const PlaneFlood& flood) const {
    const auto cols = static_cast<std::uint32_t>(image_.cols),
               side = static_cast<std::uint32_t>(squares_.square);
    std::vector<std::uint32_t> squares;
    for (const std::uint32_t i : flood.samples) {
      const auto sample = static_cast<std::uint32_t>(thinned_.whole_index(i));
      squares.push_back(sample / cols / side * static_cast<std::uint32_t>(grid_.cols) + sample % cols / side);
    }
    std::sort(squares.begin(), squares.end());
    squares.erase(std::unique(squares.begin(), squares.end()), squares.end());
    return squares;
  }

  const RangeImage& image_;
  const SquarePlanes& squares_;
  const SquareGrid& grid_;
  const std::vector<std::uint32_t>& labels_;
  const SuperclusterOptions& options_;
  PlaneRegions& regions_;
  std::vector<Plane>& planes_;
  ThinnedImage thinned_;
  const RangeImage& seen_;
  std::size_t least_;
  double sigma_m_;
  std::vector<std::uint8_t> use_;  // SampleUse
  PlaneFlooder flooder_;
  FreeIslands islands_;
  std::vector<Vec3> blocked_normals_;  // of floods that bend, by number of the sample
  std::unordered_map<std::uint32_t, RayPlane> plane_of_small_;  // by region + 1
  SquarePresence presence_;
};

}  // namespace

std::int64_t least_plane_samples(const RangeImage& image, const SuperclusterOptions& options) {
  return std::max<std::int64_t>(options.min_plane_samples, static_cast<std::int64_t>(image.count() / 200000));
}

SquarePresence recover_small_planes(device::Queue& queue, const RangeImage& image,
                                    const SquarePlanes& squares, const SquareGrid& grid,
                                    const std::vector<std::uint32_t>& labels,
                                    const SuperclusterOptions& options, PlaneRegions& regions,
                                    std::vector<Plane>& planes) {
  SmallPlanes small(image, squares, grid, labels, options, regions, planes);
  small.recover(find_window_seeds(queue, small.seen(), small.use(), squares.noise, options.tile));
  small.recover(find_sparse_seeds(small.seen(), small.use(), squares.noise));
  return small.presence();
}

}  // namespace hybrid::stages
