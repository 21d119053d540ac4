#include "stages/planes/curved_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <unordered_set>

#include "core/parallel.hpp"
#include "stages/planes/bending.hpp"
#include "stages/planes/square_contact.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostSamples = 40000;  // of a region in the quadratic fit
constexpr double kMostMargin = 8;            // samples
constexpr double kShareFaint =
    0.001;                            // of the squared residuals, where the surface goes on and bends as much
constexpr double kLikeCurvature = 2;  // factor between here and there
constexpr std::array<int, 3> kRingsBeyond = {4, 8,
                                             16};  // squares that the surface is followed beyond the region
constexpr double kLeastGrowth = 2;                 // of the number of squares within those
constexpr double kShareBeyond = 0.3, kShareSmooth = 0.7;  // of the squared residuals of their centroids
constexpr double kLeastLike = 10, kNotUnlike = -4;  // bends_like() where these bend, and where they only bend
constexpr std::size_t kNoFragment = 16;             // squares
constexpr double kMostTurnAcross = 0.3;             // rad: across a region that goes on, narrowly
constexpr double kCreaseFrom = 2.5 * std::numbers::pi / 180, kCreaseTo = 30 * std::numbers::pi / 180;
constexpr double kBendSigmas = 4;
constexpr double kFlatBend = 0.25;          // of the curvature that the turn of the neighbours would make
constexpr std::size_t kFewestOfCore = 400;  // samples
constexpr double kBulgeScatter = 0.3;    // rms of a parabola about its mean, over its height: 2 / (3 sqrt 5)
constexpr double kMostBulge = 2;         // times the scatter
constexpr std::size_t kWidestFacet = 8;  // squares; a strip w squares wide has w / 2 squares per rim edge
constexpr std::size_t kMuchLarger = 8;

// Every stride-th sample of the region's squares that lies on its plane.
PlaneHeights heights(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                     const SuperclusterOptions& options, const PlaneRegion& region) {
  const int n = squares.square;
  const std::size_t total = region.squares.size() * static_cast<std::size_t>(n * n);
  const std::size_t stride = (total + kMostSamples - 1) / kMostSamples;
  const double reach_m =
      options.label_sigmas * std::max(squares.sigma_m, region.fit.rms_m) + options.waviness_m;
  // So many samples of a face that stands on this one lie on both.
  const double spacing_m = region.fit.centroid.norm() * image.step_rad();
  const int rim = static_cast<int>(std::lround(std::min(reach_m / std::max(spacing_m, 1e-9), kMostMargin)));
  const auto on_plane = [&](int row, int col) {
    col = image.wrapped(col);
    if (row < 0 || row >= image.rows || col < 0 || col >= image.cols) return false;
    const double height = region.fit.plane.distance(image.point(image.index(row, col)));
    return std::abs(height) <= reach_m;  // false for NaN
  };
  PlaneHeights samples;
  for (std::size_t at = 0; at < total; at += stride) {
    const std::uint32_t square = region.squares[at / static_cast<std::size_t>(n * n)];
    const int inside = static_cast<int>(at % static_cast<std::size_t>(n * n));
    const int row = static_cast<int>(square) / grid.cols * n + inside / n;
    const int col = static_cast<int>(square) % grid.cols * n + inside % n;
    if (row >= image.rows || col >= image.cols || !on_plane(row, col)) continue;
    const Vec3 height = region.fit.in_frame(image.point(image.index(row, col)));
    samples.add(height, {on_plane(row, col + 1), on_plane(row + 1, col), on_plane(row, col - 1),
                         on_plane(row - 1, col)});
    if (rim > 1 && on_plane(row, col + rim) && on_plane(row + rim, col) && on_plane(row, col - rim) &&
        on_plane(row - rim, col))
      samples.core.push_back(height);
  }
  return samples;
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Square b outside meets square a of the region in a kink of less than 30 degrees without a step.
bool in_contact(const RangeImage& image, const SquarePlanes& squares, const SuperclusterOptions& options,
                const SquareRecord& a, const SquareRecord& b) {
  return in_contact(
      image, squares,
      ContactLimits{kCreaseTo, options.angle_sigmas, options.distance_factor, options.offset_sigmas}, a, b);
}

// A square that straddles a small step is turned, but the one beyond it is parallel again; one that straddles
// a corner is turned a little, the one beyond it far more than a curved surface would go on.
bool straddles(const SquarePlanes& squares, const SquareGrid& grid, const Vec3& normal, std::size_t square,
               int direction) {
  const std::int64_t beyond = grid.neighbour(square, direction);
  if (beyond == SquareGrid::kNone) return false;
  const SquareRecord& after = squares.squares[static_cast<std::size_t>(beyond)];
  if (after.state != SQUARE_PLANAR) return false;
  const double here = angle_between(normal, square_normal(squares.squares[square]));
  const double there = angle_between(normal, square_normal(after));
  return there < 0.5 * here || there > std::max(4 * here, kCreaseTo);
}

// Most of the rim is in contact with squares that, on the mean, turn away (or all towards): one such normal
// may be noise, their mean is not.
bool is_facet(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
              const SuperclusterOptions& options, const PlaneRegions& regions, std::uint32_t id) {
  const PlaneRegion& region = regions.regions[id - 1];
  const Vec3& normal = region.fit.plane.normal;
  int rim = 0, contacts = 0;
  double bend = 0, reach = 0, variance = 0;
  for (const std::uint32_t square : region.squares)
    for (int direction = 0; direction < 4; ++direction) {
      const std::int64_t neighbour = grid.neighbour(square, direction);
      if (neighbour == SquareGrid::kNone) continue;
      const auto other = static_cast<std::size_t>(neighbour);
      const std::uint32_t owner = regions.of_square[other];
      if (owner == id) continue;
      rim += 1;
      if (owner != 0 && regions.regions[owner - 1].squares.size() > kMuchLarger * region.squares.size())
        continue;
      const SquareRecord &here = squares.squares[square], &next = squares.squares[other];
      if (!in_contact(image, squares, options, here, next) ||
          straddles(squares, grid, normal, other, direction))
        continue;
      contacts += 1;
      const Vec3 step = square_centroid(next) - square_centroid(here);
      const Vec3 outward = (step - step.dot(normal) * normal).normalized();
      bend += square_normal(next).dot(outward);
      reach += step.norm();
      variance += next.sigma_normal * next.sigma_normal;
    }
  // A wide region bends visibly itself when it is curved: bends() decides.
  if (region.squares.size() > kWidestFacet / 2 * static_cast<std::size_t>(rim)) return false;
  // If its neighbours' turn went on across the region, it would bulge, and scatter about its plane by 0.3 of
  // that; when it scatters less, what turns at its rim are the edges of a flat face.
  const double width = std::sqrt(12 * region.fit.spread[0] / region.fit.weight);
  const double bulge = std::abs(bend) / std::max(reach, 1e-9) * width * width / 8;
  if (kBulgeScatter * bulge > kMostBulge * region.fit.rms_m) return false;
  if (!(contacts > options.max_crease_share * rim && std::abs(bend) > kCreaseFrom * contacts &&
        std::abs(bend) > kBendSigmas * std::sqrt(variance)))
    return false;
  const PlaneHeights samples = heights(image, squares, grid, options, region);
  const Bend own = bend_of(samples.core.size() >= kFewestOfCore ? samples.core : samples.inner, 0);
  const bool flat = own.determined && own.curvature + kBendSigmas * own.sigma <
                                          kFlatBend * std::abs(bend) / std::max(reach, 1e-9);
  return !flat;
}

// Where the surface goes on beyond the region, `rings` squares far without an edge: its squares' centroids in
// the region's frame. Their noise is that of many samples, and they reach further than a narrow strip.
std::vector<Vec3> heights_beyond(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                                 const SuperclusterOptions& options, const PlaneRegion& region, int rings) {
  std::vector<std::uint32_t> reached;
  std::copy_if(region.squares.begin(), region.squares.end(), std::back_inserter(reached),
               [&](std::uint32_t square) { return squares.squares[square].state == SQUARE_PLANAR; });
  const std::size_t own = reached.size();
  std::unordered_set<std::uint32_t> seen(reached.begin(), reached.end());
  std::size_t from = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (const std::size_t to = reached.size(); from < to; ++from)
      for (int direction = 0; direction < 4; ++direction) {
        const std::int64_t neighbour = grid.neighbour(reached[from], direction);
        if (neighbour == SquareGrid::kNone) continue;
        const auto other = static_cast<std::uint32_t>(neighbour);
        if (in_contact(image, squares, options, squares.squares[reached[from]], squares.squares[other]) &&
            seen.insert(other).second)
          reached.push_back(other);
      }
  std::vector<Vec3> heights;
  if (static_cast<double>(reached.size()) < kLeastGrowth * static_cast<double>(own)) return heights;
  for (const std::uint32_t square : reached)
    heights.push_back(region.fit.in_frame(square_centroid(squares.squares[square])));
  return heights;
}

// A narrow strip of a wide vault, or a patch of it straight above the scanner that all columns share, bends
// by less than its noise, or than rims of flat faces may seem to. It is curved when the surface around goes
// on and bends, and either as much or so that its bend laid on the region explains that better than none;
// where the region cannot tell, it is a part of what is smooth around it.
bool goes_on_bending(const PlaneRegion& region, const Bend& here, const std::vector<Vec3>& own,
                     const std::vector<Vec3>& wide, double min_curvature, bool laid_on) {
  const Bend beyond = bend_of(wide, min_curvature);
  if (beyond.share < kShareBeyond) return false;
  if (here.share >= kShareFaint && beyond.curvature < kLikeCurvature * here.curvature &&
      here.curvature < kLikeCurvature * beyond.curvature)
    return true;
  const double width = std::sqrt(12 * region.fit.spread[0] / region.fit.weight);
  return laid_on && width * beyond.curvature < kMostTurnAcross &&
         bends_like(own, wide) > (beyond.share < kShareSmooth ? kLeastLike : kNotUnlike);
}

bool bends(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
           const SuperclusterOptions& options, const PlaneRegion& region, bool fragments) {
  const PlaneHeights own = heights(image, squares, grid, options, region);
  const Bend here = own.bend(options.min_curvature);
  if (here.share >= kLeastShareBent) return true;
  const bool is_flat = here.determined && kBendSigmas * here.sigma < options.min_curvature;
  const bool laid_on = fragments || region.squares.size() >= kNoFragment;
  if (here.share < kShareFaint && (!laid_on || (here.share == 0 && is_flat))) return false;
  return std::any_of(kRingsBeyond.begin(), kRingsBeyond.end(), [&](int rings) {
    return goes_on_bending(region, here, own.inner,
                           heights_beyond(image, squares, grid, options, region, rings),
                           options.min_curvature, laid_on);
  });
}

}  // namespace

void mark_curved_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                         const SuperclusterOptions& options, bool fragments, PlaneRegions& regions) {
  struct Verdict {
    bool facet = false, curved = false;
  };
  std::vector<Verdict> verdicts(regions.regions.size());
  parallel_for(regions.regions.size(), [&](std::size_t i) {
    const PlaneRegion& region = regions.regions[i];
    if (region.curved || region.squares.empty()) return;
    Verdict& verdict = verdicts[i];
    verdict.facet = is_facet(image, squares, grid, options, regions, static_cast<std::uint32_t>(i + 1));
    verdict.curved = verdict.facet || bends(image, squares, grid, options, region, fragments);
  });
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    regions.regions[i].curved |= verdicts[i].curved;
    regions.regions[i].facet |= verdicts[i].facet;
  }
}

}  // namespace hybrid::stages
