#include "stages/planes/square_planes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "geometry/tiles.hpp"
#include "lib/random.h"
#include "shared/params_square_planes.h"
#include "stages/scan/range_noise.hpp"

namespace hybrid::stages {
namespace {

SquarePlanesParams make_params(const SquarePlaneOptions& options, double sigma_m) {
  SquarePlanesParams params{};
  params.hypotheses = static_cast<std::uint32_t>(options.hypotheses);
  params.seed = static_cast<std::uint32_t>(options.seed);
  params.score = options.score == "paper" ? SQUARE_SCORE_PAPER : SQUARE_SCORE_MSAC;
  params.fit = options.fit == "eigen" ? SQUARE_FIT_EIGEN : SQUARE_FIT_RANSAC;
  const double least = std::ceil(options.min_valid_share * options.square * options.square - 1e-9);
  params.min_valid = std::max(3u, static_cast<std::uint32_t>(least));
  params.min_inlier_share = static_cast<float>(options.min_inlier_share);
  params.threshold_m = static_cast<float>(options.threshold_sigmas * sigma_m + options.threshold_m);
  params.sigma_m = static_cast<float>(sigma_m);
  params.min_cosine = static_cast<float>(options.min_cosine);
  return params;
}

int squares_over(int samples, int side) {
  return (samples + side - 1) / side;
}

}  // namespace

std::vector<std::uint32_t> sample_triplets(int side, std::uint32_t seed) {
  const auto count = static_cast<std::uint32_t>(side * side);
  const int least_area = std::max(1, (side - 1) * (side - 1) / 4);  // twice the triangle's, in grid steps
  const auto row = [&](std::uint32_t i) { return static_cast<int>(i) / side; };
  const auto col = [&](std::uint32_t i) { return static_cast<int>(i) % side; };
  std::vector<std::uint32_t> triplets;
  for (std::uint32_t draw = 0; triplets.size() < SQUARE_TRIPLETS; ++draw) {
    const std::uint32_t a = random_below(seed, draw, 0, count), b = random_below(seed, draw, 1, count),
                        c = random_below(seed, draw, 2, count);
    const int area = (row(b) - row(a)) * (col(c) - col(a)) - (row(c) - row(a)) * (col(b) - col(a));
    if (std::abs(area) >= least_area) triplets.push_back(a | b << 8 | c << 16);
  }
  return triplets;
}

const std::vector<OptionRow<SquarePlaneOptions>>& square_plane_option_table() {
  using O = SquarePlaneOptions;
  static const std::vector<OptionRow<O>> table = {
      // The last field is spelt out because GCC 12 crashes on its default here.
      {"square", "samples", &O::square, 3, 16, "side of a square; or \"auto\": by noise and spacing", {}},
      {"hypotheses", "", &O::hypotheses, 1, SQUARE_TRIPLETS, "test planes per square", {}},
      {"sigma_m", "m", &O::sigma_m, 0, 1, "range noise along the ray; 0 = estimated from the scan", {}},
      {"threshold_sigmas",
       "",
       &O::threshold_sigmas,
       0,
       20,
       "inliers lie within this many sigmas along the ray",
       {}},
      {"threshold_m", "m", &O::threshold_m, 0, 1, "... and this", {}},
      {"min_valid_share",
       "",
       &O::min_valid_share,
       0,
       1,
       "squares with fewer valid samples are undersampled",
       {}},
      {"min_inlier_share", "", &O::min_inlier_share, 0, 1, "share of valid samples a plane must hold", {}},
      {"min_cosine",
       "",
       &O::min_cosine,
       0.001,
       1,
       "cosine of incidence below which noise grows no further",
       {}},
      {"score", "", &O::score, 0, 0, "which of the qualifying planes wins", {"paper", "msac"}},
      {"fit", "", &O::fit, 0, 0, "test planes and refit, or one fit to all samples", {"ransac", "eigen"}},
      {"seed", "", &O::seed, 0, 2147483647, "of the random triplets", {}},
      {"tile", "samples", &O::tile, 16, 16384, "side of a tile on the device", {}}};
  return table;
}

SquarePlanes fit_square_planes(device::Queue& queue, const RangeImage& image,
                               const SquarePlaneOptions& options) {
  const int side = options.square;
  if (side < 3 || side > 16) fail_input("square: expected 3 to 16 samples, found {}", side);
  SquarePlanes planes{side, squares_over(image.rows, side), squares_over(image.cols, side), 0, {}, {}};
  planes.sigma_m = options.sigma_m > 0 ? options.sigma_m : estimate_range_noise(image);
  planes.squares.resize(static_cast<std::size_t>(planes.rows) * static_cast<std::size_t>(planes.cols));

  auto params = make_params(options, planes.sigma_m);
  const auto triplets = queue.array(sample_triplets(side, params.seed));
  const auto& kernel = queue.kernel("square_planes", {{"VW", queue.vector_width()}, {"SQUARE", side}});
  const auto image_cols = static_cast<std::size_t>(image.cols);
  for (const Tile& tile : make_tiles(image.rows, image.cols, options.tile, side * SQUARE_BLOCK)) {
    params.rows = static_cast<std::uint32_t>(tile.rows);
    params.cols = static_cast<std::uint32_t>(tile.cols);
    params.first_square_row = static_cast<std::uint32_t>(tile.row / side);
    params.first_square_col = static_cast<std::uint32_t>(tile.col / side);
    const device::Rect samples{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                               params.rows, params.cols};
    const device::Rect squares{params.first_square_row, params.first_square_col,
                               static_cast<std::size_t>(squares_over(tile.rows, side)),
                               static_cast<std::size_t>(squares_over(tile.cols, side))};
    auto x = queue.array<float>(samples.rows * samples.cols),
         y = queue.array<float>(samples.rows * samples.cols),
         z = queue.array<float>(samples.rows * samples.cols);
    queue.write_rect(x, image.x.data(), image_cols, samples);
    queue.write_rect(y, image.y.data(), image_cols, samples);
    queue.write_rect(z, image.z.data(), image_cols, samples);
    auto records = queue.array<SquareRecord>(squares.rows * squares.cols);
    const auto lanes = static_cast<std::size_t>(queue.vector_width());
    const auto grid = device::grid((squares.cols + lanes - 1) / lanes * squares.rows);
    queue.launch("square_planes", kernel, device::uneven(grid), params, x, y, z, triplets, records);
    queue.read_rect(records, planes.squares.data(), static_cast<std::size_t>(planes.cols), squares);
  }
  planes.noise =
      options.sigma_m > 0 ? RangeNoise{options.sigma_m} : fit_range_noise(planes.squares, planes.sigma_m);
  return planes;
}

}  // namespace hybrid::stages
