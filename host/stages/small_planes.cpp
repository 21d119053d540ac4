#include "stages/small_planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <unordered_map>

#include "core/disjoint_sets.hpp"
#include "core/large_vector.hpp"
#include "core/parallel.hpp"
#include "core/parallel_uneven.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_window_planes.h"
#include "stages/coplanar_merge.hpp"
#include "stages/flood_shape.hpp"
#include "stages/free_islands.hpp"
#include "stages/plane_floods.hpp"
#include "stages/plane_steps.hpp"
#include "stages/sparse_seeds.hpp"

namespace hybrid::stages {
namespace {

constexpr double kStep_rad = 0.001;
constexpr int kMostStride = 8;
constexpr float kWindowShare = 0.7f;      // of a window's samples, as METHOD 2 asks of a square
constexpr float kWindowSigmas = 4;        // of chi2's standard deviation
constexpr float kWindowCosine = 0.02f;    // noise along rays nearer to grazing leaves no plane
constexpr double kLeastNoise_m = 1e-4;    // as estimate_range_noise(): what floats and the model leave
constexpr int kBlock = 64, kAround = 16;  // samples; floods of a block look so far around it
constexpr double kMostChi2 = 1.6;         // per sample
constexpr double kFoundBySquares = 0.25;  // of the samples
constexpr double kSameNormal = 0.998;     // cosine
constexpr double kFollowing = 2;          // standard deviations
constexpr double kMostBesideCurved = 0.3;
constexpr double kMostOn = 0.8;
constexpr double kMostWorse = 30;  // chi2 of the three numbers that two planes have more than one

// Of a scan with smaller steps than kStep_rad windows of a few samples say little, their noise is wider than
// they are: planes are looked for among every so many rows and columns.
int thinning(const RangeImage& image) {
  const double step_rad = image.step_rad();
  return step_rad > 0 ? std::clamp(static_cast<int>(kStep_rad / step_rad), 1, kMostStride) : 1;
}

std::size_t from_thinned(const RangeImage& image, const RangeImage& thinned, int stride, std::size_t i) {
  const auto cols = static_cast<std::size_t>(thinned.cols), every = static_cast<std::size_t>(stride);
  return i / cols * every * static_cast<std::size_t>(image.cols) + i % cols * every;
}

// Points and mask only.
RangeImage thin(const RangeImage& image, int stride) {
  RangeImage to;
  to.rows = (image.rows + stride - 1) / stride;
  to.cols = (image.cols + stride - 1) / stride;
  to.wraps = image.wraps;
  for (int row = 0; row < to.rows; ++row)
    to.elevation_rad.push_back(image.elevation_rad[static_cast<std::size_t>(row * stride)]);
  for (int col = 0; col < to.cols; ++col)
    to.azimuth_rad.push_back(image.azimuth_rad[static_cast<std::size_t>(col * stride)]);
  for (auto* values : {&to.x, &to.y, &to.z}) resize_large(*values, to.count());
  resize_large(to.mask, to.count());
  parallel_for(
      to.count(),
      [&](std::size_t i) {
        const std::size_t from = from_thinned(image, to, stride, i);
        to.x[i] = image.x[from];
        to.y[i] = image.y[from];
        to.z[i] = image.z[from];
        to.mask[i] = image.mask[from];
      },
      1 << 14);
  return to;
}

template <typename Label>
std::vector<std::uint8_t> free_samples(const RangeImage& image, const Label& label,
                                       const PlaneRegions& regions) {
  std::vector<std::uint8_t> use;
  resize_large(use, image.count());
  parallel_for(
      use.size(),
      [&](std::size_t i) {
        if (image.mask[i] != kMeasured) return;
        const std::uint32_t id = label(i);
        use[i] = id == 0 ? kFree : regions.regions[id - 1].curved ? kBlocked : kNotFree;
      },
      1 << 14);
  return use;
}

// Tile by tile: what tries them sorts.
std::vector<WindowSeed> find_seeds(device::Queue& queue, const RangeImage& image,
                                   const std::vector<std::uint8_t>& use, const RangeNoise& noise,
                                   int tile_side) {
  std::vector<WindowSeed> seeds;
  const auto width = static_cast<std::size_t>(image.cols);
  const auto rows = static_cast<std::size_t>(std::min(image.rows, tile_side)),
             cols = static_cast<std::size_t>(std::min(image.cols, tile_side));
  const std::size_t most = (rows + WINDOW_REACH - 1) * (cols + WINDOW_REACH - 1);
  auto x = queue.array<float>(most), y = queue.array<float>(most), z = queue.array<float>(most);
  auto free = queue.array<std::uint8_t>(most), shape = queue.array<std::uint8_t>(rows * cols);
  std::vector<std::uint8_t> shapes(rows * cols);
  for (const Tile& tile : make_tiles(image.rows, image.cols, tile_side)) {
    WindowPlanesParams params{};
    params.rows = static_cast<std::uint32_t>(tile.rows);
    params.cols = static_cast<std::uint32_t>(tile.cols);
    params.halo_rows =
        static_cast<std::uint32_t>(std::min(tile.rows + WINDOW_REACH - 1, image.rows - tile.row));
    params.halo_cols =
        static_cast<std::uint32_t>(std::min(tile.cols + WINDOW_REACH - 1, image.cols - tile.col));
    params.noise = noise.record();
    params.chi2_sigmas = kWindowSigmas;
    params.min_share = kWindowShare;
    params.min_cosine = kWindowCosine;
    const device::Rect rect{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                            params.halo_rows, params.halo_cols};
    queue.write_rect(x, image.x.data(), width, rect);
    queue.write_rect(y, image.y.data(), width, rect);
    queue.write_rect(z, image.z.data(), width, rect);
    queue.write_rect(free, use.data(), width, rect);
    queue.launch("window_planes", queue.kernel("window_planes"), device::grid(params.cols, params.rows),
                 params, x, y, z, free, shape);
    queue.read_rect(shape, shapes.data(), params.cols, {0, 0, params.rows, params.cols});
    for (std::uint32_t k = 0; k < params.rows * params.cols; ++k)
      if (shapes[k] != 0) {
        const auto i = static_cast<std::uint32_t>(image.index(tile.row + static_cast<int>(k / params.cols),
                                                              tile.col + static_cast<int>(k % params.cols)));
        seeds.push_back({i, static_cast<std::uint8_t>(shapes[k] - 1), i, 0});
      }
  }
  return seeds;
}

struct Candidate {
  std::size_t size = 0;
  WindowSeed seed;
  // Of a heap's order: the largest first, ties by the first sample, then by the first shape.
  bool operator<(const Candidate& other) const {
    return size != other.size                 ? size < other.size
           : seed.sample != other.seed.sample ? seed.sample > other.seed.sample
                                              : seed.shape > other.seed.shape;
  }
};

// Candidates whose floods may meet each other: of an island, or of several that a window looks into. The
// largest groups first.
std::vector<std::vector<Candidate>> groups_of(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                              const FreeIslands& islands,
                                              const std::vector<Candidate>& candidates) {
  DisjointSets sets(islands.count());
  for (const Candidate& one : candidates)
    for (const std::uint32_t i : seed_samples(image, use, one.seed))
      sets.join(islands.island(one.seed.member), islands.island(i));
  std::map<std::uint32_t, std::vector<Candidate>> of;
  for (const Candidate& one : candidates) of[sets.of(islands.island(one.seed.member))].push_back(one);
  std::vector<std::vector<Candidate>> groups;
  for (auto& [first, group] : of) groups.push_back(std::move(group));
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

// A flood that is a plane, and in whose place it came.
struct Found {
  Candidate as;
  PlaneFlood flood;
  PlaneRegion region;
};

// Floods from the seeds of each block that no earlier flood of the block covers, no farther than kAround: how
// much a seed is worth. Blocks do not see each other.
std::vector<Candidate> try_seeds(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                 const RangeNoise& noise, const std::vector<WindowSeed>& seeds,
                                 std::size_t least) {
  const int block_cols = (image.cols + kBlock - 1) / kBlock, block_rows = (image.rows + kBlock - 1) / kBlock;
  std::vector<std::vector<WindowSeed>> of_block(static_cast<std::size_t>(block_cols) *
                                                static_cast<std::size_t>(block_rows));
  for (const WindowSeed& seed : seeds) {
    const int row = static_cast<int>(seed.sample) / image.cols,
              col = static_cast<int>(seed.sample) % image.cols;
    of_block[static_cast<std::size_t>(row / kBlock * block_cols + col / kBlock)].push_back(seed);
  }
  std::vector<std::vector<Candidate>> found(of_block.size());
  parallel_for(of_block.size(), [&](std::size_t b) {
    const int row = static_cast<int>(b) / block_cols * kBlock,
              col = static_cast<int>(b) % block_cols * kBlock;
    const int top = std::max(row - kAround, 0), left = std::max(col - kAround, 0);
    const Tile limits{top, left, std::min(row + kBlock + kAround, image.rows) - top,
                      std::min(col + kBlock + kAround, image.cols) - left};
    if (of_block[b].empty()) return;
    std::sort(of_block[b].begin(), of_block[b].end(),
              [](const auto& one, const auto& other) { return one.sample < other.sample; });
    BlockFloods floods(image, use, noise, limits);
    for (const WindowSeed& seed : of_block[b]) {
      if (!floods.is_open(seed.member)) continue;
      const std::size_t size = floods.flood(seed, least);
      if (size >= least) found[b].push_back({size, seed});
    }
  });
  std::vector<Candidate> candidates;
  for (const auto& list : found) candidates.insert(candidates.end(), list.begin(), list.end());
  return candidates;
}

// Of a sample of an image with every `stride`th row and column.
std::uint32_t square_of(const RangeImage& image, const SquareGrid& grid, int side, int stride,
                        std::uint32_t sample) {
  const auto cols = static_cast<std::uint32_t>(image.cols), n = static_cast<std::uint32_t>(side),
             every = static_cast<std::uint32_t>(stride);
  return sample / cols * every / n * static_cast<std::uint32_t>(grid.cols) + sample % cols * every / n;
}

// Squares found the flood's plane on their own, too few for a supercluster.
bool squares_found(const PlaneRegions& regions, const PlaneFlood& flood, int stride, double waviness_m) {
  const Plane plane = flood.plane.plane();
  const double samples = static_cast<double>(flood.samples.size()) * stride * stride;
  return std::any_of(regions.regions.begin(), regions.regions.end(), [&](const PlaneRegion& region) {
    return region.few && region.moments.weight >= kFoundBySquares * samples &&
           region.fit.plane.normal.dot(plane.normal) >= kSameNormal &&
           std::abs(plane.distance(region.fit.centroid)) <= waviness_m;
  });
}

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

// What a flood becomes. kTaken: a plane; kBlocked: part of a curved surface; kFree: neither.
SampleUse judge(const RangeImage& image, const std::vector<std::uint8_t>& use, const PlaneFlood& flood,
                const PlaneRegion& region, bool scattered, double sigma_m, double min_curvature,
                const std::function<Vec3(std::uint32_t)>& blocked_normal) {
  const Plane plane = flood.plane.plane();
  const auto beside_curved = std::count_if(flood.samples.begin(), flood.samples.end(), [&](std::uint32_t i) {
    return meets_curved_surface(image, use, plane, sigma_m, i, blocked_normal);
  });
  const auto samples = static_cast<double>(flood.samples.size());
  if (static_cast<double>(beside_curved) > kMostBesideCurved * samples ||
      is_strip_of_smooth_surface(image, flood, sigma_m, kMostBesideCurved) ||
      flood_bends(image, flood, region, min_curvature, scattered))
    return kBlocked;
  return scattered ? kFree : kTaken;
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

// Squares in which the flood has samples, sorted.
std::vector<std::uint32_t> squares_of(const PlaneFlood& flood, const RangeImage& image,
                                      const SquareGrid& grid, int side, int stride) {
  std::vector<std::uint32_t> squares;
  for (const std::uint32_t i : flood.samples) squares.push_back(square_of(image, grid, side, stride, i));
  std::sort(squares.begin(), squares.end());
  squares.erase(std::unique(squares.begin(), squares.end()), squares.end());
  return squares;
}

}  // namespace

std::int64_t least_plane_samples(const RangeImage& image, const SuperclusterOptions& options) {
  return std::max<std::int64_t>(options.min_plane_samples, static_cast<std::int64_t>(image.count() / 200000));
}

SquarePresence recover_small_planes(device::Queue& queue, const RangeImage& image,
                                    const SquarePlanes& squares, const SquareGrid& grid,
                                    const std::vector<std::uint32_t>& labels,
                                    const SuperclusterOptions& options, PlaneRegions& regions,
                                    std::vector<Plane>& planes) {
  const int stride = thinning(image);
  const RangeImage thinned = stride > 1 ? thin(image, stride) : RangeImage();
  const RangeImage& seen = stride > 1 ? thinned : image;
  const auto label = [&](std::size_t i) {
    return labels[stride > 1 ? from_thinned(image, thinned, stride, i) : i];
  };
  const auto least = static_cast<std::size_t>(least_plane_samples(seen, options));
  const double sigma_m = std::max(squares.sigma_m, kLeastNoise_m);
  auto use = free_samples(seen, label, regions);
  const PlaneFlooder flooder(seen, use, squares.noise);
  const FreeIslands islands(seen, use);
  // Normals of floods that bend, by number of the sample; regions that do are known by their labels.
  std::vector<Vec3> blocked_normals(islands.numbers());
  const auto blocked_normal = [&](std::uint32_t i) -> Vec3 {
    return label(i) != 0 ? regions.regions[label(i) - 1].fit.plane.normal
                         : blocked_normals[islands.number(i)];
  };
  // What a flood is, without its tongues if that makes it a plane.
  const auto judged = [&](PlaneFlood& flood, PlaneRegion& region) {
    const auto verdict = [&](const PlaneFlood& one) {
      region = region_of_flood(seen, one);
      const bool scattered = one.chi2 > kMostChi2 * static_cast<double>(one.samples.size() - 3) &&
                             !(squares_found(regions, one, stride, options.waviness_m) &&
                               !follows_neighbours(seen, squares.noise, one));
      return judge(seen, use, one, region, scattered, sigma_m, options.min_curvature, blocked_normal);
    };
    const SampleUse whole = verdict(flood);
    if (whole != kBlocked) return whole;
    const PlaneRegion of_whole = region;
    PlaneFlood body = flooder.without_tongues(flood);
    if (body.samples.size() >= least && body.samples.size() < flood.samples.size() &&
        verdict(body) == kTaken) {
      flood = std::move(body);
      return kTaken;
    }
    region = of_whole;
    return whole;
  };
  const auto flood_group = [&](const std::vector<Candidate>& candidates) {
    std::vector<Found> found;
    std::priority_queue<Candidate> heap(candidates.begin(), candidates.end());
    while (!heap.empty()) {
      Candidate best = heap.top();
      heap.pop();
      PlaneFlood flood = flooder.flood(best.seed);
      const std::size_t size = flood.samples.size();
      if (size < least) continue;
      const bool smaller = size < best.size;  // others took samples
      best.size = std::min(best.size, size);
      if (smaller && !heap.empty() && size < heap.top().size) {  // not its turn yet
        heap.push(best);
        continue;
      }
      PlaneRegion region;
      const SampleUse verdict = judged(flood, region);
      if (verdict == kFree) continue;
      for (const std::uint32_t i : flood.samples) use[i] = verdict;
      if (verdict == kBlocked)
        for (const std::uint32_t i : flood.samples)
          blocked_normals[islands.number(i)] = region.fit.plane.normal;
      else
        found.push_back({best, std::move(flood), std::move(region)});
    }
    return found;
  };
  SquarePresence presence;
  std::unordered_map<std::uint32_t, RayPlane> plane_of_small;
  const auto recover = [&](const std::vector<WindowSeed>& seeds) {
    const auto groups = groups_of(seen, use, islands, try_seeds(seen, use, squares.noise, seeds, least));
    std::vector<std::vector<Found>> of_group(groups.size());
    parallel_for_uneven(groups.size(), [&](std::size_t k) { of_group[k] = flood_group(groups[k]); });
    std::vector<Found> found;  // in the order of one heap
    for (auto& list : of_group) std::move(list.begin(), list.end(), std::back_inserter(found));
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return b.as < a.as; });
    for (Found& one : found) {
      const PlaneFlood& flood = one.flood;
      PlaneRegion& region = one.region;
      region.squares = squares_of(flood, seen, grid, squares.square, stride);
      std::uint32_t id = coplanar_region(image, squares, grid, options, regions, region);
      std::optional<RayPlane> joint;
      if (id != 0 && regions.regions[id - 1].small) {
        joint = joint_plane(seen, plane_of_small.at(id), flood, options.waviness_m);
        if (!joint) id = 0;
      } else if (id != 0 && !lies_on(seen, flood, planes[id - 1], squares.noise, options)) {
        id = 0;  // the two agree within what their few squares say: samples will tell (rejoin_planes)
      }
      if (id == 0) {
        regions.regions.push_back(region);
        planes.push_back(flood.plane.plane());
        id = static_cast<std::uint32_t>(regions.regions.size());
        plane_of_small.emplace(id, flood.plane);
      } else if (joint) {
        PlaneRegion& continued = regions.regions[id - 1];
        continued.squares.insert(continued.squares.end(), region.squares.begin(), region.squares.end());
        continued.moments.merge(region.moments);
        continued.fit = fit_plane(continued.moments);
        planes[id - 1] = joint->plane();
        plane_of_small.at(id) = *joint;
      }
      for (const std::uint32_t square : region.squares) presence.emplace_back(square, id);
    }
  };
  recover(find_seeds(queue, seen, use, squares.noise, options.tile));
  recover(find_sparse_seeds(seen, use, squares.noise));
  std::sort(presence.begin(), presence.end());
  presence.erase(std::unique(presence.begin(), presence.end()), presence.end());
  return presence;
}

}  // namespace hybrid::stages
