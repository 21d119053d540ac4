#include "stages/planes/flood_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/median.hpp"
#include "stages/planes/bending.hpp"
#include "stages/planes/step_sharing.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostHeights = 4000;  // of a flood in a quadratic fit
constexpr std::size_t kNarrow = 4;          // samples
constexpr double kLeastEdge = 10 * std::numbers::pi / 180;
constexpr double kMostTurnOnwards = 0.25;  // of what the surface turned before
constexpr double kFlat = 0.07;
constexpr int kStripSides = 4;

// Index of the node `steps` beyond sample `i` to the right, below, left or above; none outside the image.
std::optional<std::uint32_t> beyond(const RangeImage& image, std::uint32_t i, int side, int steps) {
  const int row = static_cast<int>(i) / image.cols + steps * ((side == 1) - (side == 3));
  int col = static_cast<int>(i) % image.cols + steps * ((side == 0) - (side == 2));
  col = image.wrapped(col);
  if (row < 0 || row >= image.rows || col < 0 || col >= image.cols) return std::nullopt;
  return static_cast<std::uint32_t>(image.index(row, col));
}

bool covers(const PlaneFlood& flood, std::uint32_t sample) {
  return std::binary_search(flood.samples.begin(), flood.samples.end(), sample);
}

// Angle by which a step leaves the plane, signed.
double slope(const Vec3& normal, const Vec3& step) {
  const double out = normal.dot(step);
  return std::atan2(out, std::sqrt(std::max(step.squaredNorm() - out * out, 0.0)));
}

// One side of a strip: where the surface goes on beyond the rim.
struct StripRim {
  std::size_t smooth = 0;                     // samples from which it does
  std::array<std::vector<double>, 3> slopes;  // of the steps to them, and of the second and third beyond them

  // Beyond an edge lies another plane. Then the surface turns on by the second step and no more after that,
  // where a curved one turns by half as much again; or it does not turn at all up to the rim, where a curved
  // strip two samples wide turns by a seventh of what it has turned at the third step.
  bool is_edge() {
    if (slopes[0].empty() || 2 * slopes[0].size() < smooth) return false;
    const double rim = median(slopes[0]), second = median(slopes[1]), third = median(slopes[2]);
    const double turned = second - rim, turns = third - second;
    return (std::abs(turned) >= kLeastEdge && turns * turned < kMostTurnOnwards * turned * turned) ||
           (std::abs(third) >= 2 * kLeastEdge && std::abs(rim) < kFlat * std::abs(third));
  }
};

// The surface goes on beyond sample `i` for two more samples outside the flood, across the strip: along it
// one may step from sample to sample of another face. Only the first of the two may be a noisy step away:
// noise must not make an edge of 90 degrees shallow.
void look_beyond(const RangeImage& image, const PlaneFlood& flood, const Plane& plane, double slack_m,
                 int side, std::uint32_t i, StripRim& rim) {
  const auto first = beyond(image, i, side, 1), second = beyond(image, i, side, 2);
  if (!first || !second || covers(flood, *first) || covers(flood, *second)) return;
  if (image.mask[*first] != kMeasured || image.mask[*second] != kMeasured) return;
  const Vec3 from = image.point(i), to = image.point(*first), on = image.point(*second);
  if (!surface_goes_on(plane, from, to, slack_m) || !surface_goes_on(plane, to, on, 0)) return;
  rim.smooth += 1;
  const auto before = beyond(image, i, side, -1), third = beyond(image, i, side, 3);
  if (!before || !covers(flood, *before) || !third || image.mask[*third] != kMeasured ||
      !surface_goes_on(plane, on, image.point(*third), slack_m))
    return;
  rim.slopes[0].push_back(slope(plane.normal, from - image.point(*before)));
  rim.slopes[1].push_back(slope(plane.normal, on - to));
  rim.slopes[2].push_back(slope(plane.normal, image.point(*third) - on));
}

}  // namespace

PlaneRegion region_of_flood(const RangeImage& image, const PlaneFlood& flood) {
  PlaneRegion region;
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

bool flood_bends(const RangeImage& image, const PlaneFlood& flood, const PlaneRegion& region,
                 double min_curvature, bool scattered) {
  const std::size_t stride = (flood.samples.size() + kMostHeights - 1) / kMostHeights;
  PlaneHeights heights;
  for (std::size_t k = 0; k < flood.samples.size(); k += stride) {
    std::array<bool, kStripSides> neighbours{};
    for (int side = 0; side < kStripSides; ++side) {
      const auto next = beyond(image, flood.samples[k], side, 1);
      neighbours[static_cast<std::size_t>(side)] = next && covers(flood, *next);
    }
    heights.add(region.fit.in_frame(image.point(flood.samples[k])), neighbours);
  }
  const Bend bend = scattered ? bend_of(heights.all, min_curvature) : heights.bend(min_curvature);
  return bend.share >= kLeastShareBent;
}

bool is_strip_of_smooth_surface(const RangeImage& image, const PlaneFlood& flood, double sigma_m,
                                double share) {
  const auto row = [&](std::uint32_t i) { return i / static_cast<std::uint32_t>(image.cols); };
  std::vector<std::uint8_t> cols(static_cast<std::size_t>(image.cols));
  for (const std::uint32_t i : flood.samples) cols[i % static_cast<std::uint32_t>(image.cols)] = 1;
  const auto rows = static_cast<std::size_t>(row(flood.samples.back()) - row(flood.samples.front()) + 1);
  const auto width = static_cast<std::size_t>(std::count(cols.begin(), cols.end(), 1));
  if (flood.samples.size() >= kNarrow * std::max(rows, width)) return false;
  const Plane plane = flood.plane.plane();
  std::size_t smooth = 0;
  for (int side = rows >= width ? 0 : 1; side < kStripSides; side += 2) {
    StripRim rim;
    for (const std::uint32_t i : flood.samples)
      look_beyond(image, flood, plane, kContinuitySigmas * sigma_m, side, i, rim);
    if (!rim.is_edge()) smooth += rim.smooth;
  }
  return static_cast<double>(smooth) > share * static_cast<double>(flood.samples.size());
}

bool meets_curved_surface(const RangeImage& image, const std::vector<std::uint8_t>& use, const Plane& plane,
                          double sigma_m, std::uint32_t sample,
                          const std::function<Vec3(std::uint32_t)>& blocked_normal) {
  const int row = static_cast<int>(sample) / image.cols, col = static_cast<int>(sample) % image.cols;
  for (int r = std::max(row - kUseReach, 0); r <= std::min(row + kUseReach, image.rows - 1); ++r)
    for (int step = -kUseReach; step <= kUseReach; ++step) {
      const int c = image.wrapped(col + step);
      if (c < 0 || c >= image.cols) continue;
      const std::size_t other = image.index(r, c);
      if (use[other] == kBlocked &&
          std::abs(blocked_normal(static_cast<std::uint32_t>(other)).dot(plane.normal)) >
              std::numbers::sqrt2 / 2 &&
          surface_goes_on(plane, image.point(sample), image.point(other), kContinuitySigmas * sigma_m))
        return true;
    }
  return false;
}

}  // namespace hybrid::stages
