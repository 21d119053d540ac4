#include "stages/scan/stray_samples.hpp"

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_stray_samples.h"

namespace hybrid::stages {
namespace {

static_assert(STRAY_NONE == kNotStray && STRAY_BETWEEN == kBetweenSurfaces && STRAY_ISOLATED == kIsolated);

constexpr double kMinCosine = 0.02;  // as in METHOD 2: no sample is that precise across a grazing plane

// Measured points of the tile and of STRAY_WINDOW nodes around it, NaN where there are none.
struct TilePoints {
  std::vector<float> x, y, z;

  TilePoints(const RangeImage& image, const Tile& tile) {
    const auto width = static_cast<std::size_t>(tile.cols) + 2 * STRAY_WINDOW;
    const auto height = static_cast<std::size_t>(tile.rows) + 2 * STRAY_WINDOW;
    for (auto* values : {&x, &y, &z}) values->assign(width * height, std::numeric_limits<float>::quiet_NaN());
    parallel_for(height, [&](std::size_t r) {
      const int row = tile.row - STRAY_WINDOW + static_cast<int>(r);
      if (row < 0 || row >= image.rows) return;
      for (std::size_t c = 0; c < width; ++c) {
        int col = tile.col - STRAY_WINDOW + static_cast<int>(c);
        // An image narrower than the window must not meet its own samples again around the turn.
        if (image.cols > 2 * STRAY_WINDOW) col = image.wrapped(col);
        if (col < 0 || col >= image.cols) continue;
        const std::size_t from = image.index(row, col), to = r * width + c;
        if (image.mask[from] != kMeasured) continue;
        x[to] = image.x[from], y[to] = image.y[from], z[to] = image.z[from];
      }
    });
  }
};

StraySamplesParams stray_params(const Tile& tile, double sigma_m, const StrayOptions& options) {
  StraySamplesParams params{};
  params.rows = static_cast<std::uint32_t>(tile.rows);
  params.cols = static_cast<std::uint32_t>(tile.cols);
  params.noise_m = static_cast<float>(options.noise_sigmas * std::sqrt(2.0) * sigma_m);
  params.plane_tolerance_m = static_cast<float>(options.plane_sigmas * sigma_m);
  params.min_cosine = static_cast<float>(kMinCosine);
  params.steep = static_cast<float>(options.steep);
  params.gap = static_cast<float>(options.gap);
  params.min_planar_share = static_cast<float>(options.planar_share);
  params.min_near_share = static_cast<float>(options.near_share);
  params.least_neighbours = static_cast<std::uint32_t>(options.least_neighbours);
  return params;
}

}  // namespace

std::vector<std::uint8_t> find_stray_samples(device::Queue& queue, const RangeImage& image,
                                             const std::vector<std::uint32_t>& sample_label, double sigma_m,
                                             const StrayOptions& options) {
  if (sample_label.size() != image.count())
    fail(ErrorKind::failed, "find_stray_samples: {} sample labels for an image of {} samples",
         sample_label.size(), image.count());
  std::vector<std::uint8_t> result(image.count(), kNotStray);
  const auto lanes = static_cast<std::size_t>(queue.vector_width());
  for (const Tile& tile : make_tiles(image.rows, image.cols, options.tile)) {
    const device::Rect rect{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                            static_cast<std::size_t>(tile.rows), static_cast<std::size_t>(tile.cols)};
    const TilePoints points(image, tile);
    const auto x = queue.array(points.x), y = queue.array(points.y), z = queue.array(points.z);
    auto label = queue.array<std::uint32_t>(rect.rows * rect.cols);
    auto stray = queue.array<std::uint8_t>(rect.rows * rect.cols);
    const auto width = static_cast<std::size_t>(image.cols);
    queue.write_rect(label, sample_label.data(), width, rect);
    queue.launch("stray_samples", queue.kernel("stray_samples", {{"VW", queue.vector_width()}}),
                 device::grid((rect.cols + lanes - 1) / lanes, rect.rows),
                 stray_params(tile, sigma_m, options), x, y, z, label, stray);
    queue.read_rect(stray, result.data(), width, rect);
  }
  return result;
}

}  // namespace hybrid::stages
