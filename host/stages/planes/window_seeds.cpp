#include "stages/planes/window_seeds.hpp"

#include <algorithm>

#include "geometry/tiles.hpp"
#include "shared/params_window_planes.h"

namespace hybrid::stages {
namespace {

constexpr float kWindowShare = 0.7f;    // of a window's samples, as METHOD 2 asks of a square
constexpr float kWindowSigmas = 4;      // of chi2's standard deviation
constexpr float kWindowCosine = 0.02f;  // noise along rays nearer to grazing leaves no plane

}  // namespace

std::vector<WindowSeed> find_window_seeds(device::Queue& queue, const RangeImage& image,
                                          const std::vector<std::uint8_t>& use, const RangeNoise& noise,
                                          int tile_side) {
  std::vector<WindowSeed> seeds;
  const auto width = static_cast<std::size_t>(image.cols);
  const auto rows = static_cast<std::size_t>(std::min(image.rows, tile_side)),
             cols = static_cast<std::size_t>(std::min(image.cols, tile_side));
  const auto lanes = static_cast<std::size_t>(queue.vector_width());
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
    queue.launch("window_planes", queue.kernel("window_planes", {{"VW", queue.vector_width()}}),
                 device::grid((params.cols + lanes - 1) / lanes, params.rows), params, x, y, z, free, shape);
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

}  // namespace hybrid::stages
