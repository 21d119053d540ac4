#include "stages/scan/resample.hpp"

#include <algorithm>
#include <cmath>

#include "core/log.hpp"
#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_resample.h"
#include "stages/scan/columns.hpp"
#include "stages/scan/organised_grid.hpp"

namespace hybrid::stages {
namespace {

using Float2 = std::array<float, 2>;
using Float4 = std::array<float, 4>;

// The samples a tile can see: those of its rows and as far beyond as slopes beside a gap reach.
struct TileSamples {
  std::vector<std::uint32_t> begin;  // per column of the tile, and the end
  std::vector<float> position;
  std::vector<Float4> sample;         // x y z range
  std::vector<std::uint32_t> source;  // index in the scan
};

TileSamples gather(const Scan& scan, const ScanColumns& columns, const Tile& tile, double max_gap) {
  const float margin = static_cast<float>(2 * max_gap + 2);
  const float above = static_cast<float>(tile.row) - margin,
              below = static_cast<float>(tile.row + tile.rows) + margin;
  std::vector<std::size_t> first;
  TileSamples seen{{0}, {}, {}, {}};
  std::size_t total = 0;
  for (int c = tile.col; c < tile.col + tile.cols; ++c) {
    const auto at = [&](std::size_t k) {
      return columns.row_position.begin() + static_cast<std::ptrdiff_t>(columns.begin[k]);
    };
    const auto from =
        std::lower_bound(at(static_cast<std::size_t>(c)), at(static_cast<std::size_t>(c) + 1), above);
    const auto to = std::lower_bound(from, at(static_cast<std::size_t>(c) + 1), below);
    first.push_back(static_cast<std::size_t>(from - columns.row_position.begin()));
    total += static_cast<std::size_t>(to - from);
    seen.begin.push_back(static_cast<std::uint32_t>(total));
  }
  seen.position.resize(total);
  seen.sample.resize(total);
  seen.source.resize(total);
  parallel_for(first.size(), [&](std::size_t c) {
    for (std::size_t k = seen.begin[c]; k < seen.begin[c + 1]; ++k) {
      const std::size_t from = first[c] + (k - seen.begin[c]);
      const auto& p = scan.points[columns.samples[from]];
      const Vec3 point = scan.origin + Vec3(p[0], p[1], p[2]);
      seen.position[k] = columns.row_position[from];
      seen.source[k] = columns.samples[from];
      seen.sample[k] = {static_cast<float>(point.x()), static_cast<float>(point.y()),
                        static_cast<float>(point.z()), static_cast<float>(point.norm())};
    }
  });
  return seen;
}

std::vector<Float2> rays(const std::vector<double>& angles, int first, int count) {
  std::vector<Float2> table;
  for (int i = first; i < first + count; ++i) {
    const double angle = angles[static_cast<std::size_t>(i)];
    table.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))});
  }
  return table;
}

void resample_tile(device::Queue& queue, const TileSamples& seen, const Tile& tile, double step_rad,
                   const ResampleOptions& options, RangeImage& image) {
  const ResampleParams params{
      static_cast<std::uint32_t>(tile.row),   static_cast<std::uint32_t>(tile.rows),
      static_cast<std::uint32_t>(tile.cols),  static_cast<float>(step_rad),
      static_cast<float>(options.max_gap),    static_cast<float>(options.jump_m),
      static_cast<float>(options.jump_slope), static_cast<float>(options.jump_factor)};
  const auto begin = queue.array(seen.begin);
  const auto position = queue.array(seen.position);
  const auto sample = queue.array(seen.sample);
  const auto ray_row = queue.array(rays(image.elevation_rad, tile.row, tile.rows));
  const auto ray_col = queue.array(rays(image.azimuth_rad, tile.col, tile.cols));
  const auto rows = static_cast<std::size_t>(tile.rows), cols = static_cast<std::size_t>(tile.cols);
  const std::size_t nodes = rows * cols;
  auto range = queue.array<float>(nodes), x = queue.array<float>(nodes), y = queue.array<float>(nodes),
       z = queue.array<float>(nodes);
  auto mask = queue.array<std::uint8_t>(nodes);
  auto pick = queue.array<std::uint32_t>(nodes);
  queue.launch("resample", queue.kernel("resample"),
               device::grid(cols, (rows + RESAMPLE_STRIP - 1) / RESAMPLE_STRIP), params, begin, position,
               sample, ray_row, ray_col, range, x, y, z, mask, pick);

  const device::Rect rect{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col), rows, cols};
  const auto image_cols = static_cast<std::size_t>(image.cols);
  queue.read_rect(range, image.range_m.data(), image_cols, rect);
  queue.read_rect(x, image.x.data(), image_cols, rect);
  queue.read_rect(y, image.y.data(), image_cols, rect);
  queue.read_rect(z, image.z.data(), image_cols, rect);
  queue.read_rect(mask, image.mask.data(), image_cols, rect);
  const auto picks = queue.read(pick);
  parallel_for(rows, [&](std::size_t r) {
    for (std::size_t c = 0; c < cols; ++c) {
      const std::uint32_t taken = picks[r * cols + c];
      image.source[(rect.row + r) * image_cols + rect.col + c] =
          taken == RESAMPLE_NO_SAMPLE ? kNoSource : seen.source[taken];
    }
  });
}

void carry_attributes(const Scan& scan, RangeImage& image) {
  if (!scan.intensity.empty()) image.intensity.assign(image.count(), 0.0f);
  if (!scan.rgb.empty()) image.rgb.assign(image.count(), {0, 0, 0});
  if (scan.intensity.empty() && scan.rgb.empty()) return;
  parallel_for(
      image.count(),
      [&](std::size_t i) {
        const std::uint32_t source = image.source[i];
        if (source == kNoSource) return;
        if (!scan.intensity.empty()) image.intensity[i] = scan.intensity[source];
        if (!scan.rgb.empty()) image.rgb[i] = scan.rgb[source];
      },
      4096);
}

// Returns that no node took: copies of a measured node's point (some scanners write every column twice) are
// duplicates, the others extra.
void list_extra(const Scan& scan, const ScanColumns& columns, RangeImage& image) {
  std::vector<bool> left(scan.points.size(), false);
  for (const std::uint32_t sample : columns.samples) left[sample] = true;
  for (const std::uint32_t source : image.source)
    if (source != kNoSource) left[source] = false;
  std::vector<std::uint32_t> beside;
  for (std::size_t i = 0; i < left.size(); ++i)
    if (left[i]) beside.push_back(static_cast<std::uint32_t>(i));

  std::vector<std::array<float, 3>> taken;
  if (!beside.empty())
    for (const std::uint32_t source : image.source)
      if (source != kNoSource) taken.push_back(scan.points[source]);
  std::sort(taken.begin(), taken.end());
  for (const std::uint32_t sample : beside) {
    const bool copy = std::binary_search(taken.begin(), taken.end(), scan.points[sample]);
    (copy ? image.duplicates : image.extra).push_back(sample);
  }
}

// Empties the nodes nearer than `min_range_m`: what was measured there is kept beside the grid, but is no
// part of the scene.
void set_aside_near(double min_range_m, RangeImage& image) {
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (!(image.range_m[i] < min_range_m)) continue;
    if (image.mask[i] == kMeasured) image.extra.push_back(image.source[i]);
    image.mask[i] = kEmpty;
    image.source[i] = kNoSource;
    image.range_m[i] = image.x[i] = image.y[i] = image.z[i] = NAN;
    if (!image.intensity.empty()) image.intensity[i] = 0;
    if (!image.rgb.empty()) image.rgb[i] = {0, 0, 0};
  }
  std::sort(image.extra.begin(), image.extra.end());
}

}  // namespace

const std::vector<OptionRow<ResampleOptions>>& resample_option_table() {
  using O = ResampleOptions;
  static const std::vector<OptionRow<O>> table = {
      {"min_range_m", "m", &O::min_range_m, 0, 1000,
       "returns nearer than this (the scanner's own body) are kept, but are no part of the scene"},
      {"max_gap", "rows", &O::max_gap, 1, 16, "longest gap of a column that is interpolated", {}},
      {"jump_m", "m", &O::jump_m, 0, 10, "difference in range that is never a depth jump", {}},
      {"jump_slope",
       "",
       &O::jump_slope,
       0,
       10,
       "further difference allowed per length of arc across the gap",
       {}},
      {"jump_factor",
       "",
       &O::jump_factor,
       0,
       10,
       "further difference allowed, in parts of what the slope beside the gap predicts",
       {}},
      {"tile", "samples", &O::tile, 16, 16384, "side of a tile on the device", {}}};
  return table;
}

RangeImage resample_scan(device::Queue& queue, const Scan& scan, const ResampleOptions& options) {
  if (scan.organised() || scan.range_grid) {
    RangeImage image = arrange_grid(scan);
    set_aside_near(options.min_range_m, image);
    return image;
  }
  const ScanColumns columns = recover_columns(scan);

  RangeImage image = make_range_image(columns.rows, columns.count());
  for (int row = 0; row < image.rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] =
        columns.top_elevation_rad - row * columns.elevation_step_rad;
  image.azimuth_rad = columns.azimuth_rad;
  image.wraps = columns.wraps;
  for (const Tile& tile : make_tiles(image.rows, image.cols, options.tile))
    resample_tile(queue, gather(scan, columns, tile, options.max_gap), tile, columns.elevation_step_rad,
                  options, image);
  carry_attributes(scan, image);
  list_extra(scan, columns, image);
  set_aside_near(options.min_range_m, image);
  log::debug("scan {}: {} sweeps in {} columns x {} rows, {} samples beside the grid, {} duplicates",
             scan.name, columns.sweeps, image.cols, image.rows, image.extra.size(), image.duplicates.size());
  return image;
}

}  // namespace hybrid::stages
