#include "stages/planes/rejoin_planes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/parallel_blocks.hpp"
#include "stages/planes/plane_gap.hpp"
#include "stages/planes/ray_plane.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostLooked = 1024;    // samples of a plane
constexpr std::size_t kVoteBlock = 1 << 18;  // samples
constexpr double kTiltedCosine = 0.98;       // of the normals of a plane and a part that samples have tilted
constexpr double kMostApart_m = 0.02;        // of a part's centre from the plane
constexpr double kAsClose = 1.3;             // a part's residuals about the plane to those about its own
constexpr double kLeastOwn = 0.5;            // standard deviations; few samples fit their own plane too well
// Standard deviations: samples this close that lie to both sides are the plane's however well another fits
// them, for it crosses the plane and took those that lie its way.
constexpr double kCrossing = 1.5, kTurnsMost = 2, kCentred = 0.5;
constexpr double kTakingTurns = 0.25;  // of a part's samples, that have one of the plane beside them
constexpr double kMostPredicted = 1;   // variances of noise that the plane is uncertain by
constexpr double kLongestWalk_rad = 0.06, kShortestWalk = 64;  // between the two; the second in nodes

int longest_walk(const RangeImage& image) {
  const double step_rad = image.step_rad();
  const double most = std::max(image.rows, image.cols);
  return static_cast<int>(
      std::clamp(kLongestWalk_rad / step_rad, kShortestWalk, std::max(most, kShortestWalk)));
}

// Samples of a plane: every `stride`th of `count`, a power of 2 that leaves less than 2 kMostLooked.
struct Looked {
  std::vector<std::uint32_t> samples;
  std::size_t count = 0, stride = 1;
  Vec3 mean = Vec3::Zero();
  std::optional<RayPlane> fit;  // to the samples looked at; for what the plane is uncertain by
};

std::vector<Looked> look_at(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                            const PlaneRegions& regions) {
  const auto counts = [&](std::size_t i) { return labels[i] != 0 && image.mask[i] == kMeasured; };
  // Of every block of samples: how many of each plane come before its own.
  std::vector<std::vector<std::uint32_t>> before((labels.size() + kVoteBlock - 1) / kVoteBlock);
  for_blocks(labels.size(), kVoteBlock, [&](std::size_t block, std::size_t begin, std::size_t end) {
    before[block].resize(regions.regions.size());
    for (std::size_t i = begin; i < end; ++i)
      if (counts(i)) before[block][labels[i] - 1] += 1;
  });
  std::vector<Looked> of(regions.regions.size());
  for (auto& block : before)
    for (std::size_t k = 0; k < of.size(); ++k)
      of[k].count += std::exchange(block[k], static_cast<std::uint32_t>(of[k].count));
  for (Looked& looked : of) {
    while ((looked.count + looked.stride - 1) / looked.stride >= 2 * kMostLooked) looked.stride *= 2;
    looked.samples.resize((looked.count + looked.stride - 1) / looked.stride);
  }
  for_blocks(labels.size(), kVoteBlock, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!counts(i)) continue;
      Looked& looked = of[labels[i] - 1];
      const std::size_t number = before[block][labels[i] - 1]++;
      if (number % looked.stride == 0) looked.samples[number / looked.stride] = static_cast<std::uint32_t>(i);
    }
  });
  for (Looked& looked : of) {
    for (const std::uint32_t i : looked.samples) looked.mean += image.point(i);
    if (looked.count > 0) looked.mean /= static_cast<double>(looked.samples.size());
  }
  return of;
}

class Rejoining {
 public:
  Rejoining(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
            const SuperclusterOptions& options, const std::vector<Plane>& planes,
            const std::vector<std::uint32_t>& labels, PlaneRegions& regions)
      : image_(image),
        squares_(squares),
        grid_(grid),
        options_(options),
        planes_(planes),
        labels_(labels),
        regions_(regions),
        looked_(look_at(image, labels, regions)) {}

  // By label: the one that has its samples now.
  std::vector<std::uint32_t> join() {
    std::vector<std::uint32_t> heir(planes_.size() + 1), order;
    std::iota(heir.begin(), heir.end(), 0u);
    for (std::uint32_t label = 1; label < heir.size(); ++label)
      if (!regions_.regions[label - 1].curved && looked_[label - 1].count > 0) order.push_back(label);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return weight(a) > weight(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t a = order[i];
      if (heir[a] != a) continue;
      std::vector<std::uint32_t> rim = rim_squares(grid_, regions_, a);
      for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t j = i + 1; j < order.size(); ++j) {
          const std::uint32_t b = order[j];
          if (heir[b] != b || !is_part(b, a, heir)) continue;
          const auto part = rim_squares(grid_, regions_, b);
          if (!takes_turns(b, a, heir) && is_seen_through_between(b, part, a, rim, heir)) continue;
          rim.insert(rim.end(), part.begin(), part.end());
          heir[b] = a;
          changed = true;
        }
      }
    }
    return heir;
  }

 private:
  // Planes that own squares come before those that do not, large ones before small ones.
  std::pair<bool, std::size_t> weight(std::uint32_t label) const {
    return {!regions_.regions[label - 1].small, looked_[label - 1].count};
  }

  struct Closeness {
    double median, mean;  // of the residuals' sizes and of the residuals, in standard deviations
  };
  Closeness closeness(const Looked& part, const Plane& plane, const Looked* of_plane) const {
    std::vector<double> sizes;
    double sum = 0;
    for (const std::uint32_t i : part.samples) {
      const Vec3 point = image_.point(i);
      const double range = point.norm(), along = plane.normal.dot(point);
      const double sigma = squares_.noise.at(range, std::abs(along) / range);
      const double predicted = of_plane ? predicted_variance(*of_plane, point) : 0;
      const double residual = range * (1 - along / plane.offset_m) / (sigma * std::sqrt(1 + predicted));
      sizes.push_back(std::abs(residual));
      sum += residual;
    }
    const auto middle = sizes.begin() + std::ssize(sizes) / 2;
    std::nth_element(sizes.begin(), middle, sizes.end());
    return {*middle, sum / static_cast<double>(sizes.size())};
  }

  struct Walks {
    int arrived = 0, clean = 0;  // and nothing behind the plane was seen on the way
  };

  // From samples of a part along rows and columns to the nearest of the plane.
  Walks walk(std::uint32_t part, std::uint32_t of, const std::vector<std::uint32_t>& heir) const {
    Walks walks;
    const Plane& plane = planes_[of - 1];
    const int longest = longest_walk(image_);
    const double behind_m = seen_through_m(squares_, options_);
    for (const std::uint32_t start : looked_[part - 1].samples)
      for (int direction = 0; direction < 4; ++direction) {
        int row = static_cast<int>(start) / image_.cols, col = static_cast<int>(start) % image_.cols;
        int behind = 0;
        for (int step = 1; step <= longest; ++step) {
          row += (direction == 0) - (direction == 1);
          col += (direction == 2) - (direction == 3);
          col = image_.wrapped(col);
          if (row < 0 || row >= image_.rows || col < 0 || col >= image_.cols) break;
          const std::size_t i = image_.index(row, col);
          const std::uint32_t label = heir[labels_[i]];
          if (label == part) break;  // another one sets out there
          if (label == of) {
            walks.arrived += 1;
            walks.clean += behind == 0;
            break;
          }
          behind += image_.mask[i] == kMeasured && plane.distance(image_.point(i)) < -behind_m;
        }
      }
    return walks;
  }

  // The two share a surface sample by sample, each taking those that lie its way: nothing is between them.
  bool takes_turns(std::uint32_t part, std::uint32_t of, const std::vector<std::uint32_t>& heir) const {
    std::size_t beside = 0;
    for (const std::uint32_t i : looked_[part - 1].samples) {
      const int row = static_cast<int>(i) / image_.cols, col = static_cast<int>(i) % image_.cols;
      const auto holds = [&](int r, int c) {
        c = image_.wrapped(c);
        return r >= 0 && r < image_.rows && c >= 0 && c < image_.cols &&
               heir[labels_[image_.index(r, c)]] == of;
      };
      beside += holds(row - 1, col) || holds(row + 1, col) || holds(row, col - 1) || holds(row, col + 1);
    }
    return static_cast<double>(beside) >=
           kTakingTurns * static_cast<double>(looked_[part - 1].samples.size());
  }

  // Samples of the two that are close to each other tell; their squares where there are none.
  bool is_seen_through_between(std::uint32_t part, const std::vector<std::uint32_t>& part_rim,
                               std::uint32_t of, const std::vector<std::uint32_t>& rim,
                               const std::vector<std::uint32_t>& heir) const {
    const Walks walks = walk(part, of, heir);
    if (walks.arrived > 0) return 2 * walks.clean < walks.arrived;
    return is_seen_through(image_, squares_, planes_[of - 1], nearest_squares(grid_, rim, part_rim),
                           options_);
  }

  static double predicted_variance(const Looked& looked, const Vec3& point) {
    return looked.fit->prediction_variance(point) * static_cast<double>(looked.samples.size()) /
           static_cast<double>(looked.count);
  }

  bool fitted(Looked& looked) const {
    if (!looked.fit) {
      looked.fit.emplace(looked.mean);
      for (const std::uint32_t i : looked.samples) looked.fit->add(image_.point(i));
      if (!looked.fit->solve()) looked.count = 0;
    }
    return looked.count > 0;
  }

  bool is_part(std::uint32_t part, std::uint32_t of, const std::vector<std::uint32_t>& heir) {
    const Plane& plane = planes_[of - 1];
    if (plane.normal.dot(planes_[part - 1].normal) < kTiltedCosine) return false;
    const Looked& small = looked_[part - 1];
    if (std::abs(plane.distance(small.mean)) > kMostApart_m) return false;
    Looked& large = looked_[of - 1];
    if (!fitted(large) || predicted_variance(large, small.mean) > kMostPredicted) return false;
    const auto own = closeness(small, planes_[part - 1], nullptr), other = closeness(small, plane, &large);
    return other.median <= kAsClose * std::max(own.median, kLeastOwn) ||
           (other.median <= kCrossing && std::abs(other.mean) <= kCentred) ||
           (other.median <= kTurnsMost && takes_turns(part, of, heir));
  }

  const RangeImage& image_;
  const SquarePlanes& squares_;
  const SquareGrid& grid_;
  const SuperclusterOptions& options_;
  const std::vector<Plane>& planes_;
  const std::vector<std::uint32_t>& labels_;
  PlaneRegions& regions_;
  std::vector<Looked> looked_;
};

}  // namespace

std::vector<std::uint32_t> rejoin_planes(const RangeImage& image, const SquarePlanes& squares,
                                         const SquareGrid& grid, const SuperclusterOptions& options,
                                         const std::vector<Plane>& planes, std::vector<std::uint32_t>& labels,
                                         PlaneRegions& regions, SquarePresence& presence) {
  const auto heir = Rejoining(image, squares, grid, options, planes, labels, regions).join();
  std::vector<std::uint32_t> grown;
  for (std::uint32_t label = 1; label < heir.size(); ++label) {
    const std::uint32_t to = heir[label];
    if (to == label) continue;
    grown.push_back(to);
    PlaneRegion& winner = regions.regions[to - 1];
    PlaneRegion& loser = regions.regions[label - 1];
    if (winner.small)
      winner.squares.insert(winner.squares.end(), loser.squares.begin(), loser.squares.end());
    else if (!loser.small)  // a small one's squares go on being whose they are
      join_regions(regions, to, label);
    loser = PlaneRegion();
  }
  if (grown.empty()) return grown;
  parallel_for(
      labels.size(), [&](std::size_t i) { labels[i] = heir[labels[i]]; }, kVoteBlock);
  for (auto& [square, id] : presence) id = heir[id];
  std::sort(presence.begin(), presence.end());
  presence.erase(std::unique(presence.begin(), presence.end()), presence.end());
  std::sort(grown.begin(), grown.end());
  grown.erase(std::unique(grown.begin(), grown.end()), grown.end());
  return grown;
}

}  // namespace hybrid::stages
