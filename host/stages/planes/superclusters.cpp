#include "stages/planes/superclusters.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>

#include "core/large_vector.hpp"
#include "shared/params_square_links.h"
#include "stages/planes/absorb_squares.hpp"
#include "stages/planes/coplanar_merge.hpp"
#include "stages/planes/curved_regions.hpp"
#include "stages/planes/cylinder_patches.hpp"
#include "stages/planes/cylinders.hpp"
#include "stages/planes/mixed_rims.hpp"
#include "stages/planes/plane_steps.hpp"
#include "stages/planes/refuted_planes.hpp"
#include "stages/planes/rejoin_planes.hpp"
#include "stages/planes/sample_labels.hpp"
#include "stages/planes/small_planes.hpp"
#include "stages/planes/springings.hpp"
#include "stages/planes/tangent_rims.hpp"
#include "stages/scan/interleaving.hpp"

namespace hybrid::stages {
namespace {

constexpr float kReachCosine = 0.05f;  // c of the distance test

void check_extent(const RangeImage& image, const SquarePlanes& squares) {
  const int n = squares.square;
  if (n < 1 || squares.rows != (image.rows + n - 1) / n || squares.cols != (image.cols + n - 1) / n ||
      squares.squares.size() !=
          static_cast<std::size_t>(squares.rows) * static_cast<std::size_t>(squares.cols))
    fail(ErrorKind::failed,
         "grow_superclusters: {} x {} squares of side {} ({} records) do not cover an image of {} x {} "
         "samples",
         squares.rows, squares.cols, n, squares.squares.size(), image.rows, image.cols);
}

SquareLinks link_squares(device::Queue& queue, const RangeImage& image, const SquarePlanes& squares,
                         const SquareGrid& grid, const SuperclusterOptions& options) {
  SquareLinkParams params{};
  params.rows = static_cast<std::uint32_t>(grid.rows);
  params.cols = static_cast<std::uint32_t>(grid.cols);
  params.wraps = grid.wraps ? 1 : 0;
  const double reach = options.distance_factor * squares.square;
  params.row_reach_rad = static_cast<float>(reach * image.elevation_step_rad());
  params.col_reach_rad = static_cast<float>(reach * image.azimuth_step_rad());
  params.min_cosine = kReachCosine;
  params.sigma_m = static_cast<float>(squares.sigma_m);
  params.offset_sigmas = static_cast<float>(options.offset_sigmas);
  params.angle_rad = static_cast<float>(options.angle_deg * std::numbers::pi / 180);
  params.angle_sigmas = static_cast<float>(options.angle_sigmas);
  const auto records = queue.array(squares.squares);
  auto links = queue.array<float>(2 * grid.count());
  queue.launch("square_links", queue.kernel("square_links"), device::grid(grid.count()), params, records,
               links);
  return queue.read(links);
}

// Squares in the group of touching (8 neighbours) curved regions that each square belongs to; 0 = in none.
std::vector<std::size_t> curved_group_sizes(const SquareGrid& grid, const PlaneRegions& regions) {
  const auto curved = [&](std::int64_t square) {
    if (square == SquareGrid::kNone) return false;
    const std::uint32_t id = regions.of_square[static_cast<std::size_t>(square)];
    return id != 0 && regions.regions[id - 1].curved;
  };
  const auto facet = [&](std::size_t square) { return regions.regions[regions.of_square[square] - 1].facet; };
  std::vector<std::size_t> size(grid.count());
  for (std::size_t start = 0; start < size.size(); ++start) {
    if (size[start] != 0 || !curved(static_cast<std::int64_t>(start))) continue;
    std::vector<std::size_t> group = {start};
    size[start] = 1;
    for (std::size_t next = 0; next < group.size(); ++next) {
      const int row = static_cast<int>(group[next]) / grid.cols,
                col = static_cast<int>(group[next]) % grid.cols;
      for (int k = 0; k < 9; ++k) {
        const std::int64_t other = grid.at(row + k / 3 - 1, col + k % 3 - 1);
        if (!curved(other) || size[static_cast<std::size_t>(other)] != 0) continue;
        size[static_cast<std::size_t>(other)] = 1;
        group.push_back(static_cast<std::size_t>(other));
      }
    }
    const bool facets = std::any_of(group.begin(), group.end(), facet);
    for (const std::size_t square : group) size[square] = facets ? group.size() : 1;
  }
  return size;
}

// Too few squares for a supercluster, or, of curved regions that touch, for a curved surface: a few squares
// that straddle the edge of a table leg bend as well. Their samples may still make small planes.
void drop_small_regions(const SquareGrid& grid, int min_squares, PlaneRegions& regions) {
  const auto group_size = curved_group_sizes(grid, regions);
  for (PlaneRegion& region : regions.regions) {
    if (region.squares.empty()) continue;
    const std::size_t count = region.curved ? group_size[region.squares[0]] : region.squares.size();
    if (count >= static_cast<std::size_t>(min_squares)) continue;
    region.few = !region.curved;
    region.curved = false;
    for (const std::uint32_t square : region.squares) regions.of_square[square] = 0;
    region.squares.clear();
  }
}

// Squares of no region become a small plane's when it took at least half of their samples.
void own_squares(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                 const std::vector<std::uint32_t>& labels, PlaneRegions& regions) {
  const int n = squares.square;
  const auto owner = [&](int square) -> std::uint32_t {
    std::map<std::uint32_t, int> votes;
    int valid = 0;
    for (int row = square / grid.cols * n; row < std::min(square / grid.cols * n + n, image.rows); ++row)
      for (int col = square % grid.cols * n; col < std::min(square % grid.cols * n + n, image.cols); ++col) {
        const std::size_t i = image.index(row, col);
        valid += image.mask[i] != kEmpty;
        if (labels[i] != 0 && regions.regions[labels[i] - 1].small) ++votes[labels[i]];
      }
    for (const auto& [id, count] : votes)
      if (2 * count >= valid) return id;
    return 0;
  };
  for (PlaneRegion& region : regions.regions) {
    if (!region.small) continue;
    for (const std::uint32_t square : region.squares)
      if (regions.of_square[square] == 0) regions.of_square[square] = owner(static_cast<int>(square));
    region.squares.clear();
  }
  for (std::size_t i = 0; i < regions.of_square.size(); ++i)
    if (const std::uint32_t id = regions.of_square[i]; id != 0 && regions.regions[id - 1].small)
      regions.regions[id - 1].squares.push_back(static_cast<std::uint32_t>(i));
}

// New id per region: largest sample count first, ties by the first square; 0 for what became no supercluster,
// small planes left with fewer than `least` samples among it.
std::vector<std::uint32_t> number_regions(const std::vector<Supercluster>& measured,
                                          const PlaneRegions& regions, std::int64_t least) {
  std::vector<std::uint32_t> order, first(measured.size(), 0);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const PlaneRegion& region = regions.regions[i];
    if (region.curved || (region.squares.empty() && !region.small)) continue;
    if (measured[i].samples < (region.small ? least : 3)) continue;
    if (!region.squares.empty()) first[i] = *std::min_element(region.squares.begin(), region.squares.end());
    order.push_back(static_cast<std::uint32_t>(i));
  }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    if (measured[a].samples != measured[b].samples) return measured[a].samples > measured[b].samples;
    return first[a] != first[b] ? first[a] < first[b] : a < b;
  });
  std::vector<std::uint32_t> id(measured.size() + 1, 0);
  for (std::size_t k = 0; k < order.size(); ++k) id[order[k] + 1] = static_cast<std::uint32_t>(k + 1);
  return id;
}

// Regions + 1 that gained or lost more than one of `many` of their samples, about.
std::vector<std::uint32_t> much_moved(const std::vector<std::int64_t>& moved, const PlaneRegions& regions,
                                      int square, std::int64_t many = 1000) {
  std::vector<std::uint32_t> labels;
  for (std::uint32_t label = 1; label < moved.size(); ++label) {
    const auto samples = std::ssize(regions.regions[label - 1].squares) * square * square;
    if (many * moved[label] > samples) labels.push_back(label);
  }
  return labels;
}

PlaneSegmentation assemble(const SquarePlanes& squares, const SquareGrid& grid, const PlaneRegions& regions,
                           const std::vector<std::uint32_t>& id, std::vector<std::uint32_t> labels,
                           std::vector<Supercluster> measured) {
  PlaneSegmentation result;
  result.square = squares.square;
  result.square_rows = grid.rows;
  result.square_cols = grid.cols;
  result.superclusters.resize(static_cast<std::size_t>(
      std::count_if(id.begin(), id.end(), [](std::uint32_t value) { return value != 0; })));
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (id[i + 1] == 0) continue;
    measured[i].id = id[i + 1];
    measured[i].squares = static_cast<int>(regions.regions[i].squares.size());
    result.superclusters[id[i + 1] - 1] = std::move(measured[i]);
  }
  result.sample_label = std::move(labels);
  for (std::uint32_t& label : result.sample_label) label = id[label];
  result.square_label.resize(grid.count());
  result.square_class.resize(grid.count());
  for (std::size_t i = 0; i < grid.count(); ++i) {
    result.square_label[i] = id[regions.of_square[i]];
    // A member may have found no plane of its own (absorb_squares).
    const std::uint32_t state = squares.squares[i].state;
    result.square_class[i] = result.square_label[i] != 0    ? kSuperclusterMember
                             : state == SQUARE_UNDERSAMPLED ? kUndersampled
                             : state == SQUARE_PLANAR       ? kPlanarTooSmall
                                                            : kNonPlanar;
  }
  return result;
}

// Regions of squares become planes of samples: labels (index + 1 into regions) and what the samples say the
// planes are. Adds the small planes and parts that show themselves to the regions, joins and drops others.
std::vector<Plane> label_and_fit(device::Queue& queue, const RangeImage& image, const SquarePlanes& squares,
                                 const SquareGrid& grid, const SuperclusterOptions& options,
                                 PlaneRegions& regions, std::vector<std::uint32_t>& labels) {
  std::vector<Plane> planes;
  for (const PlaneRegion& region : regions.regions) planes.push_back(region.fit.plane);
  resize_large(labels, image.count());
  label_samples(queue, image, squares, grid, find_candidates(squares, grid, regions, {}), planes, options,
                labels);
  refit_planes(image, squares.square, labels, planes);
  SquarePresence presence;
  if (options.min_plane_samples > 0)
    presence = recover_small_planes(queue, image, squares, grid, labels, options, regions, planes);
  // The second pass competes with the planes refitted to the first one's labels, and with the small ones.
  const auto compete = [&] {
    return label_samples(queue, image, squares, grid, find_candidates(squares, grid, regions, presence),
                         planes, options, labels);
  };
  const auto polish = [&](PolishRounds rounds, const std::vector<std::uint32_t>& only) {
    polish_planes(image, squares.square, labels, squares.noise, planes, rounds, only);
  };
  compete();
  polish(PolishRounds::both, {});
  const std::int64_t least = least_plane_samples(image, options);
  std::vector<std::uint32_t> changed;  // in need of a last round
  const auto polish_changed = [&](const std::vector<std::uint32_t>& those) {
    if (!those.empty()) polish(PolishRounds::first, those);
    changed.insert(changed.end(), those.begin(), those.end());
  };
  if (drop_refuted_planes(image, squares.noise, planes, labels, {least, options.min_curvature}, regions,
                          presence))
    polish_changed(much_moved(compete(), regions, squares.square));
  auto grown = rejoin_planes(image, squares, grid, options, planes, labels, regions, presence);
  if (!grown.empty()) {
    const auto moved = much_moved(compete(), regions, squares.square);
    grown.insert(grown.end(), moved.begin(), moved.end());
    polish_changed(grown);
  }
  const auto [stepped, excess] = split_steps(image, grid, squares.square, squares.noise,
                                             {least, options.waviness_m}, labels, planes, regions);
  const auto trimmed =
      trim_tangent_rims(image, squares.noise, excess, labels, planes, regions, squares.square);
  const BeamWidth beam = measure_beam(image, RimCrossings(image, planes, regions, labels), labels);
  const RimTolerance tolerance{options.label_sigmas, options.waviness_m};
  // The fit holds little to rims (polish_planes): only planes of which they are much are fitted again.
  const auto of_mixed =
      much_moved(trim_mixed_rims(image, squares.noise, beam, tolerance, planes, regions, labels), regions,
                 squares.square, 50);
  for (const auto* those : {&stepped, &trimmed, &of_mixed})
    changed.insert(changed.end(), those->begin(), those->end());
  if (!changed.empty()) polish(PolishRounds::last, changed);
  return planes;
}

PlaneSegmentation segment(device::Queue& queue, const RangeImage& image, const SquarePlanes& squares,
                          const SuperclusterOptions& options) {
  const SquareGrid grid(image, squares);
  const SquareLinks links = link_squares(queue, image, squares, grid, options);
  PlaneRegions regions = grow_regions(squares, grid, links, options);
  mark_curved_regions(image, squares, grid, options, false, regions);
  merge_coplanar_regions(image, squares, grid, options, regions);
  absorb_squares(image, squares, grid, options, regions);
  // Again: fragments of a column too small to show that they bend may have merged into one that does.
  mark_curved_regions(image, squares, grid, options, true, regions);
  drop_small_regions(grid, options.min_squares, regions);

  std::vector<std::uint32_t> labels;
  const std::vector<Plane> planes = label_and_fit(queue, image, squares, grid, options, regions, labels);
  own_squares(image, squares, grid, labels, regions);
  auto measured = measure_planes(image, squares.square, labels, planes);
  const auto ids = number_regions(measured, regions, least_plane_samples(image, options));
  return assemble(squares, grid, regions, ids, std::move(labels), std::move(measured));
}

}  // namespace

const std::vector<OptionRow<SuperclusterOptions>>& supercluster_option_table() {
  using O = SuperclusterOptions;
  static const std::vector<OptionRow<O>> table = {
      {"angle", "deg", &O::angle_deg, 0.1, 45, "largest angle between neighbouring normals", {}},
      {"angle_sigmas", "", &O::angle_sigmas, 0, 10, "... or this many of its standard deviations", {}},
      {"distance_factor",
       "",
       &O::distance_factor,
       1,
       10,
       "largest distance of neighbouring centroids, in squares",
       {}},
      {"offset_sigmas",
       "",
       &O::offset_sigmas,
       1,
       10,
       "largest offset of neighbours out of plane, in sigmas",
       {}},
      {"min_squares", "squares", &O::min_squares, 1, 1e6, "superclusters with fewer squares are dropped", {}},
      {"min_plane_samples",
       "samples",
       &O::min_plane_samples,
       0,
       1e9,
       "samples of the smallest plane recovered from what those leave; 0 = none is",
       {}},
      {"min_cylinder_samples",
       "samples",
       &O::min_cylinder_samples,
       0,
       1e9,
       "samples of the smallest column or pipe found among what lies on no plane; 0 = none is",
       {}},
      {"label_sigmas",
       "",
       &O::label_sigmas,
       1,
       10,
       "a plane's samples lie within this many sigmas of noise",
       {}},
      {"waviness", "m", &O::waviness_m, 0, 0.5, "... and this: how far real walls stray from a plane", {}},
      {"most_waviness",
       "m",
       &O::most_waviness_m,
       0,
       0.5,
       "... doubled up to this as long as samples of parallel planes take turns",
       {}},
      {"min_curvature", "1/m", &O::min_curvature, 0.001, 100, "regions that bend more are no planes", {}},
      {"max_crease_share",
       "",
       &O::max_crease_share,
       0,
       1,
       "share of a rim in shallow creases that makes a facet",
       {}},
      {"tile", "samples", &O::tile, 16, 65536, "side of a tile on the device", {}},
  };
  return table;
}

PlaneSegmentation grow_superclusters(device::Queue& queue, const RangeImage& image,
                                     const SquarePlanes& squares, const SuperclusterOptions& options) {
  check_extent(image, squares);
  SuperclusterOptions tried = options;
  while (true) {
    PlaneSegmentation result = segment(queue, image, squares, tried);
    result.waviness_m = tried.waviness_m;
    result.interleaved = interleaved_share(image, result);
    const SuperclusterOptions used = tried;
    tried.waviness_m *= 2;
    if (result.interleaved > kMostInterleaved && tried.waviness_m > 0 &&
        tried.waviness_m <= options.most_waviness_m)
      continue;
    result.cylinders = find_cylinders(image, squares, result, used);
    trim_springings(image, squares.noise, used, result);
    forget_planes_on_cylinders(image, squares.noise, used, result);
    return result;
  }
}

}  // namespace hybrid::stages
