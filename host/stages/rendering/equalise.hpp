#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "stages/rendering/render_state.hpp"

namespace hybrid::stages {

// What two photographs say of the surface both see, per channel.
struct PhotographOverlap {
  std::size_t first, second;        // photographs
  std::size_t points;               // that both see, well exposed
  std::array<double, 3> log_ratio;  // median of log(light in second / light in first)
  // Pearson's, of the logarithms of their light (mean of the channels) there; NaN where the light of either
  // varies by less than 5 % (standard deviation): there is nothing to compare.
  double correlation;
};

struct PhotographOverlaps {
  std::vector<PhotographOverlap> pairs;
  std::vector<std::size_t> points;  // per photograph: of the surface, as coarse rays of all of them meet it
};

// Gains per photograph and channel (times its linear light) that make overlaps agree: least squares on the
// logarithms, each overlap weighing as its points, with mean 0 over the photographs. A weak prior holds the
// gains of photographs that overlap little at 1 (Brown and Lowe 2007, on logarithms and medians, so that
// highlights and wrong surfaces do not count).
std::vector<std::array<double, 3>> solve_gains(std::size_t photographs,
                                               const std::vector<PhotographOverlap>& overlaps);

// How well each photograph agrees with the others on what both see: the median of its pairs' correlations,
// each weighing as its points.
std::vector<PhotographAgreement> agreements_of(const PhotographOverlaps& overlaps);

// The overlaps of a scene's photographs: points on its surface where coarse rays of each photograph meet it,
// and the mean light around them in each photograph that sees them. Kernels: ray_cast, rank_photos.
PhotographOverlaps measure_overlaps(Renderer& renderer, RenderState& state);

// What brings a view from the exposure that all photographs have in common to that of the photographs it
// shows, per channel: exp(-mean of the logarithms of their gains), each pixel counting once and in it each of
// the photographs `used` as it weighs. From a grid of rays over the whole view, as one tile: no tile size and
// no thread decides, and along a path of cameras it changes as slowly as the weights do. 1 where no
// photograph sees anything. Kernels: ray_cast and those of PhotoBlend.
std::array<double, 3> view_exposure(RenderState& state, const ViewRequest& request,
                                    const std::vector<std::size_t>& used);

}  // namespace hybrid::stages
