#include "stages/small_planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <unordered_set>

#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_window_planes.h"
#include "stages/coplanar_merge.hpp"
#include "stages/curved_regions.hpp"
#include "stages/plane_floods.hpp"

namespace hybrid::stages {
namespace {

constexpr float kWindowShare = 0.7f;    // of a window's samples, as METHOD 2 asks of a square
constexpr float kWindowSigmas = 4;      // of chi2's standard deviation
constexpr float kWindowCosine = 0.02f;  // noise along rays nearer to grazing leaves no plane
constexpr double kLeastNoise_m = 1e-4;  // as estimate_range_noise(): what floats and the model leave
constexpr int kBlock = 64;              // samples; floods of a block look one block around it
constexpr double kMostChi2 = 1.25;      // per sample
constexpr double kFloodSigmas = 3;
constexpr double kMostBesideCurved = 0.3;

std::vector<std::uint8_t> free_samples(const RangeImage& image, const std::vector<std::uint32_t>& labels) {
  std::vector<std::uint8_t> use(image.count());
  parallel_for(
      use.size(), [&](std::size_t i) { use[i] = image.mask[i] == kMeasured && labels[i] == 0; }, 1 << 14);
  return use;
}

std::vector<WindowSeed> find_seeds(device::Queue& queue, const RangeImage& image,
                                   const std::vector<std::uint8_t>& use, double sigma_m, int tile_side) {
  std::vector<WindowSeed> seeds;
  const auto width = static_cast<std::size_t>(image.cols);
  for (const Tile& tile : make_tiles(image.rows, image.cols, tile_side)) {
    WindowPlanesParams params{};
    params.rows = static_cast<std::uint32_t>(tile.rows);
    params.cols = static_cast<std::uint32_t>(tile.cols);
    params.halo_rows = static_cast<std::uint32_t>(std::min(tile.rows + WINDOW_REACH - 1, image.rows - tile.row));
    params.halo_cols = static_cast<std::uint32_t>(std::min(tile.cols + WINDOW_REACH - 1, image.cols - tile.col));
    params.sigma_m = static_cast<float>(sigma_m);
    params.chi2_sigmas = kWindowSigmas;
    params.min_share = kWindowShare;
    params.min_cosine = kWindowCosine;
    const device::Rect rect{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                            params.halo_rows, params.halo_cols};
    const std::size_t count = rect.rows * rect.cols;
    auto x = queue.array<float>(count), y = queue.array<float>(count), z = queue.array<float>(count);
    auto free = queue.array<std::uint8_t>(count);
    auto shape = queue.array<std::uint8_t>(static_cast<std::size_t>(tile.rows) *
                                           static_cast<std::size_t>(tile.cols));
    queue.write_rect(x, image.x.data(), width, rect);
    queue.write_rect(y, image.y.data(), width, rect);
    queue.write_rect(z, image.z.data(), width, rect);
    queue.write_rect(free, use.data(), width, rect);
    queue.launch("window_planes", queue.kernel("window_planes"), device::grid(params.cols, params.rows),
                 params, x, y, z, free, shape);
    const auto shapes = queue.read(shape);
    for (std::size_t k = 0; k < shapes.size(); ++k)
      if (shapes[k] != 0) {
        const auto i = image.index(tile.row + static_cast<int>(k) / tile.cols, tile.col + static_cast<int>(k) % tile.cols);
        seeds.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint8_t>(shapes[k] - 1)});
      }
  }
  std::sort(seeds.begin(), seeds.end(), [](const auto& a, const auto& b) { return a.sample < b.sample; });
  return seeds;
}

struct Candidate {
  std::size_t size = 0;
  WindowSeed seed;
  // Of a heap's order: the largest first, ties by the first sample.
  bool operator<(const Candidate& other) const {
    return size != other.size ? size < other.size : seed.sample > other.seed.sample;
  }
};

// Floods from the seeds of each block that no earlier flood of the block covers, no farther than one block
// around: how much a seed is worth. Blocks do not see each other.
std::vector<Candidate> try_seeds(const RangeImage& image, const PlaneFlooder& flooder,
                                 const std::vector<WindowSeed>& seeds, std::size_t least) {
  const int block_cols = (image.cols + kBlock - 1) / kBlock, block_rows = (image.rows + kBlock - 1) / kBlock;
  std::vector<std::vector<WindowSeed>> of_block(static_cast<std::size_t>(block_cols) * static_cast<std::size_t>(block_rows));
  for (const WindowSeed& seed : seeds) {
    const int row = static_cast<int>(seed.sample) / image.cols, col = static_cast<int>(seed.sample) % image.cols;
    of_block[static_cast<std::size_t>(row / kBlock * block_cols + col / kBlock)].push_back(seed);
  }
  std::vector<std::vector<Candidate>> found(of_block.size());
  parallel_for(of_block.size(), [&](std::size_t b) {
    const int row = static_cast<int>(b) / block_cols * kBlock, col = static_cast<int>(b) % block_cols * kBlock;
    const int top = std::max(row - kBlock, 0), left = std::max(col - kBlock, 0);
    const Tile limits{top, left, std::min(row + 2 * kBlock, image.rows) - top,
                      std::min(col + 2 * kBlock, image.cols) - left};
    std::unordered_set<std::uint32_t> covered;
    for (const WindowSeed& seed : of_block[b]) {
      if (covered.contains(seed.sample)) continue;
      const PlaneFlood flood = flooder.flood(seed, limits);
      if (flood.samples.size() < least) continue;
      covered.insert(flood.samples.begin(), flood.samples.end());
      found[b].push_back({flood.samples.size(), seed});
    }
  });
  std::vector<Candidate> candidates;
  for (const auto& list : found) candidates.insert(candidates.end(), list.begin(), list.end());
  return candidates;
}

std::uint32_t square_of(const RangeImage& image, const SquareGrid& grid, int side, std::uint32_t sample) {
  const auto cols = static_cast<std::uint32_t>(image.cols), n = static_cast<std::uint32_t>(side);
  return sample / cols / n * static_cast<std::uint32_t>(grid.cols) + sample % cols / n;
}

PlaneRegion region_of(const RangeImage& image, const SquareGrid& grid, int side, const PlaneFlood& flood) {
  PlaneRegion region;
  for (const std::uint32_t i : flood.samples) region.squares.push_back(square_of(image, grid, side, i));
  std::sort(region.squares.begin(), region.squares.end());
  region.squares.erase(std::unique(region.squares.begin(), region.squares.end()), region.squares.end());
  region.small = true;
  PlaneMoments& moments = region.moments;
  moments.weight = static_cast<double>(flood.samples.size());
  for (const std::uint32_t i : flood.samples) moments.mean += image.point(i) / moments.weight;
  for (const std::uint32_t i : flood.samples) {
    const Vec3 arm = image.point(i) - moments.mean;
    moments.scatter += arm * arm.transpose();
  }
  region.fit = fit_plane(moments);
  return region;
}

// The flood bends, and not only at a rim where it took in the first samples beyond a crease: whatever side
// (right, lower, left, upper) loses its outermost samples, and without any of them, the rest bends as well.
bool flood_bends(const RangeImage& image, const PlaneFlood& flood, const PlaneRegion& region,
                 double min_curvature, bool scattered) {
  const std::size_t stride = flood.samples.size() / 4000 + 1;
  std::array<std::vector<Vec3>, 6> heights;  // four sides eroded, all of them, none
  for (std::size_t k = 0; k < flood.samples.size(); k += stride) {
    const int row = static_cast<int>(flood.samples[k]) / image.cols;
    const int col = static_cast<int>(flood.samples[k]) % image.cols;
    const Vec3 arm = image.point(flood.samples[k]) - region.fit.centroid;
    const Vec3 height(arm.dot(region.fit.axis[0]), arm.dot(region.fit.axis[1]),
                      arm.dot(region.fit.plane.normal));
    bool inside = true;
    for (int side = 0; side < 4; ++side) {
      const int r = row + (side == 1) - (side == 3);
      int c = col + (side == 0) - (side == 2);
      if (image.wraps) c = (c + image.cols) % image.cols;
      const bool covered = r >= 0 && r < image.rows && c >= 0 && c < image.cols &&
                           std::binary_search(flood.samples.begin(), flood.samples.end(),
                                              static_cast<std::uint32_t>(image.index(r, c)));
      if (covered) heights[static_cast<std::size_t>(side)].push_back(height);
      inside = inside && covered;
    }
    if (inside) heights[4].push_back(height);
    heights[5].push_back(height);
  }
  if (scattered) return bends(heights[5], min_curvature);
  return std::all_of(heights.begin(), heights.end(), [&](const auto& part) {
    return !can_bend(part) || bends(part, min_curvature);
  });
}

// Fewer than four samples wide, a flood cannot show that it bends; but a curved surface goes on smoothly beyond
// its rim, where a jamb or a leg ends in a step or an edge.
bool is_strip_of_smooth_surface(const RangeImage& image, const PlaneFlood& flood, double sigma_m) {
  const auto covered = [&](std::size_t i) {
    return std::binary_search(flood.samples.begin(), flood.samples.end(), static_cast<std::uint32_t>(i));
  };
  const Vec3 normal = flood.plane.plane().normal;
  const auto shallow = [&](std::size_t from, std::size_t to, double slack_m) {
    const Vec3 step = image.point(to) - image.point(from);
    const double out = std::abs(normal.dot(step));
    return out <= std::sqrt(std::max(step.squaredNorm() - out * out, 0.0)) + slack_m;
  };
  int top = image.rows, bottom = 0;
  std::vector<std::uint8_t> cols(static_cast<std::size_t>(image.cols));
  std::size_t smooth = 0;
  for (const std::uint32_t i : flood.samples) {
    const int row = static_cast<int>(i) / image.cols, col = static_cast<int>(i) % image.cols;
    top = std::min(top, row);
    bottom = std::max(bottom, row);
    cols[static_cast<std::size_t>(col)] = 1;
    bool goes_on = false;
    for (int side = 0; side < 4 && !goes_on; ++side) {
      std::size_t at[2];
      bool there = true;
      for (int k = 0; k < 2 && there; ++k) {
        const int r = row + (k + 1) * ((side == 1) - (side == 3));
        int c = col + (k + 1) * ((side == 0) - (side == 2));
        if (image.wraps) c = (c + image.cols) % image.cols;
        there = r >= 0 && r < image.rows && c >= 0 && c < image.cols;
        if (!there) break;
        at[k] = image.index(r, c);
        there = image.mask[at[k]] == kMeasured && !covered(at[k]);
      }
      goes_on = there && shallow(i, at[0], kFloodSigmas * sigma_m) && shallow(at[0], at[1], 0);
    }
    smooth += goes_on;
  }
  const auto length = std::max<std::ptrdiff_t>(bottom - top + 1, std::count(cols.begin(), cols.end(), 1));
  if (getenv("DBG")) fprintf(stderr, "   width %.1f smooth %.2f\n", double(flood.samples.size())/double(length), double(smooth)/double(flood.samples.size()));
  return flood.samples.size() < 4 * static_cast<std::size_t>(length) &&
         static_cast<double>(smooth) > kMostBesideCurved * static_cast<double>(flood.samples.size());
}

// Squares of curved regions and their neighbours.
std::vector<std::uint8_t> beside_curved(const SquareGrid& grid, const PlaneRegions& regions) {
  std::vector<std::uint8_t> beside(grid.count());
  for (const PlaneRegion& region : regions.regions) {
    if (!region.curved) continue;
    for (const std::uint32_t square : region.squares) {
      beside[square] = 1;
      for (int direction = 0; direction < 4; ++direction)
        if (const auto other = grid.neighbour(square, direction); other != SquareGrid::kNone)
          beside[static_cast<std::size_t>(other)] = 1;
    }
  }
  return beside;
}

// A sample of a curved flood lies within two rows and columns, less than 45 degrees out of the plane.
bool meets_curved(const RangeImage& image, const std::vector<std::uint8_t>& use, const Vec3& normal,
                  double slack_m, std::uint32_t sample) {
  const int row = static_cast<int>(sample) / image.cols, col = static_cast<int>(sample) % image.cols;
  const Vec3 from = image.point(sample);
  for (int r = std::max(row - 2, 0); r <= std::min(row + 2, image.rows - 1); ++r)
    for (int step = -2; step <= 2; ++step) {
      int c = col + step;
      if (image.wraps) c = (c + image.cols) % image.cols;
      if (c < 0 || c >= image.cols || use[image.index(r, c)] != kBlocked) continue;
      const Vec3 chord = image.point(image.index(r, c)) - from;
      const double out = std::abs(normal.dot(chord));
      if (out <= std::sqrt(std::max(chord.squaredNorm() - out * out, 0.0)) + slack_m) return true;
    }
  return false;
}

}  // namespace

std::int64_t least_plane_samples(const RangeImage& image, const SuperclusterOptions& options) {
  return std::max<std::int64_t>(options.min_plane_samples, static_cast<std::int64_t>(image.count() / 100000));
}

SquarePresence recover_small_planes(device::Queue& queue, const RangeImage& image,
                                    const SquarePlanes& squares, const SquareGrid& grid,
                                    const std::vector<std::uint32_t>& labels,
                                    const SuperclusterOptions& options, PlaneRegions& regions,
                                    std::vector<Plane>& planes) {
  const auto least = static_cast<std::size_t>(least_plane_samples(image, options));
  const double sigma_m = std::max(squares.sigma_m, kLeastNoise_m);
  auto use = free_samples(image, labels);
  const auto seeds = find_seeds(queue, image, use, sigma_m, options.tile);
  const PlaneFlooder flooder(image, use, sigma_m);
  const auto candidates = try_seeds(image, flooder, seeds, least);
  std::priority_queue<Candidate> heap(candidates.begin(), candidates.end());
  const auto beside = beside_curved(grid, regions);
  const Tile everywhere{0, 0, image.rows, image.cols};
  const auto lies_beside = [&](const PlaneFlood& flood) {
    const Vec3 normal = flood.plane.plane().normal;
    const auto count = std::count_if(flood.samples.begin(), flood.samples.end(), [&](std::uint32_t i) {
      return beside[square_of(image, grid, squares.square, i)] != 0 ||
             (!getenv("NOMEET") && meets_curved(image, use, normal, 3 * sigma_m, i));
    });
    return static_cast<double>(count) > kMostBesideCurved * static_cast<double>(flood.samples.size());
  };
  SquarePresence presence;
  while (!heap.empty()) {
    Candidate best = heap.top();
    heap.pop();
    const PlaneFlood flood = flooder.flood(best.seed, everywhere);
    const std::size_t size = flood.samples.size();
    if (size < least) continue;
    // Others took its samples: its turn comes later.
    if (size < best.size && !heap.empty() && size < heap.top().size) {
      best.size = size;
      heap.push(best);
      continue;
    }
    PlaneRegion region = region_of(image, grid, squares.square, flood);
    const bool scattered = flood.plane.squares_m2() > kMostChi2 * sigma_m * sigma_m * static_cast<double>(size - 3);
    const bool curved = lies_beside(flood) || is_strip_of_smooth_surface(image, flood, sigma_m) ||
                 flood_bends(image, flood, region, options.min_curvature, scattered);
    if (getenv("DBG")) fprintf(stderr, "flood size %zu row %d col %d chi2/n %.2f curved %d bends %d\n", size, int(best.seed.sample)/image.cols, int(best.seed.sample)%image.cols, flood.plane.squares_m2()/sigma_m/sigma_m/double(size), curved, flood_bends(image, flood, region, options.min_curvature, scattered));
    if (scattered && !curved) continue;
    for (const std::uint32_t i : flood.samples) use[i] = curved ? kBlocked : kTaken;
    if (curved) continue;
    std::uint32_t id = coplanar_region(image, squares, grid, options, regions, region);
    for (const std::uint32_t square : region.squares)
      presence.emplace_back(square, id != 0 ? id : static_cast<std::uint32_t>(regions.regions.size() + 1));
    if (id == 0) {
      regions.regions.push_back(std::move(region));
      planes.push_back(flood.plane.plane());
    } else if (PlaneRegion& continued = regions.regions[id - 1]; continued.small) {
      continued.squares.insert(continued.squares.end(), region.squares.begin(), region.squares.end());
      continued.moments.merge(region.moments);
      continued.fit = fit_plane(continued.moments);
    }
  }
  std::sort(presence.begin(), presence.end());
  presence.erase(std::unique(presence.begin(), presence.end()), presence.end());
  return presence;
}

}  // namespace hybrid::stages
