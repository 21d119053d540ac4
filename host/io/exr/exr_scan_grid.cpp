#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "io/exr/exr_scan_reader.hpp"

namespace hybrid::io {

// As stages::arrange_grid() puts the samples of read() into their nodes.
ExrScanReader::Placed ExrScanReader::place_row(const ExrScanBand& band, int band_row, int row,
                                               RangeImage& image) const {
  Placed placed;
  for (int col = 0; col < cols_; ++col) {
    const std::size_t at = band.index(band_row, col), node = image.index(row, col);
    const std::uint32_t state = channels_.mask ? band.mask[at] : std::uint32_t{kMeasured};
    if (state == kEmpty) continue;
    const auto point = point_of(band, at, row, col);
    if (state > kInterpolated || is_absurd(point)) {
      placed.problem = true;
      return placed;
    }
    if (!is_place(point)) {
      placed.lost += channels_.mask;
      continue;
    }
    image.x[node] = point[0];
    image.y[node] = point[1];
    image.z[node] = point[2];
    image.mask[node] = static_cast<std::uint8_t>(state);
    if (state == kInterpolated) {
      image.range_m[node] = interpolated_range(
          point, channels_.range ? band.range[at] : std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    ++placed.measured;
    image.range_m[node] = static_cast<float>(image.point(node).norm());
    image.source[node] = static_cast<std::uint32_t>(node);
    if (channels_.intensity) image.intensity[node] = band.intensity[at];
    if (channels_.colour)
      for (std::size_t c = 0; c < 3; ++c) image.rgb[node][c] = srgb_byte(band.colour[3 * at + c]);
  }
  return placed;
}

std::optional<GridScan> ExrScanReader::read_grid() {
  GridScan grid;
  read_head(grid.scan);
  if (!grid.scan.range_grid || extra_samples() > 0) return {};
  RangeImage& image = grid.image;
  try {
    image = make_range_image(rows_, cols_);
    if (channels_.intensity) image.intensity.resize(image.count());
    if (channels_.colour) image.rgb.resize(image.count());
  } catch (const std::bad_alloc&) {
    return {};  // read() says what is missing
  }
  image.elevation_rad = std::move(grid.scan.range_grid->elevation_rad);
  image.azimuth_rad = std::move(grid.scan.range_grid->azimuth_rad);
  image.wraps = grid.scan.range_grid->wraps;
  grid.scan.range_grid.reset();

  bool problem = false;
  std::vector<Placed> placed;
  read_bands(image.wraps, [&](const ExrScanBand& band, int row, int count) {
    placed.assign(static_cast<std::size_t>(count), {});
    parallel_for(placed.size(), [&](std::size_t r) {
      placed[r] = place_row(band, static_cast<int>(r), row + static_cast<int>(r), image);
    });
    for (const Placed& of_row : placed) {
      grid.returns += of_row.measured;
      lost_ += of_row.lost;
      problem |= of_row.problem;
    }
  });
  if (problem || grid.returns == 0) return {};
  grid.samples = nodes();
  grid.has_tables = true;
  note_states(grid.scan);
  return grid;
}

}  // namespace hybrid::io
