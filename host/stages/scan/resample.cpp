#include "stages/scan/resample.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

#include "core/log.hpp"
#include "core/parallel_blocks.hpp"
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

// What became of a return.
enum Fate : std::uint8_t { kNoReturn, kInNode, kBeside, kCopy };

// Samples of a scan by their points, to find those that others are copies of.
class SamplesByPoint {
 public:
  using Point = std::array<float, 3>;

  void add(const Point& point, std::uint32_t sample) { samples_.push_back({point, sample, false}); }

  // To be called before what follows.
  void sort() {
    tbb::parallel_sort(samples_, [](const auto& a, const auto& b) {
      return a.point != b.point ? a.point < b.point : a.sample < b.sample;
    });
    while (bits_.size() < kBitsPerSample * samples_.size()) bits_.resize(2 * bits_.size());
    for (const auto& sample : samples_) bits_[bit_of(sample.point)] = true;
  }

  // Notes that another sample has this point; on any thread.
  void meet(const Point& point) {
    if (!bits_[bit_of(point)]) return;
    const auto at = std::lower_bound(samples_.begin(), samples_.end(), point,
                                     [](const auto& sample, const Point& of) { return sample.point < of; });
    if (at != samples_.end() && at->point == point)
      std::atomic_ref(at->met).store(true, std::memory_order_relaxed);
  }

  // visit(sample) for all that were met, in no order.
  template <typename Visit>
  void for_met(const Visit& visit) const {
    bool met = false;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      met = samples_[k].met || (met && samples_[k].point == samples_[k - 1].point);
      if (met) visit(samples_[k].sample);
    }
  }

 private:
  static constexpr std::size_t kBitsPerSample = 16;  // one of 16 other points has a bit of these

  struct Sample {
    Point point;
    std::uint32_t sample;
    bool met;  // of the first with a point, for all of them
  };

  std::size_t bit_of(const Point& point) const {
    std::uint64_t bits = 0;
    for (const float length : point)  // + 0: both zeros are the same length
      bits = (bits ^ std::bit_cast<std::uint32_t>(length + 0.0f)) * 0x9e3779b97f4a7c15;
    return bits >> 32 & (bits_.size() - 1);
  }

  std::vector<Sample> samples_;
  std::vector<bool> bits_ = std::vector<bool>(64);
};

// Where a scanner writes every column twice, a sample's copy is next to it.
void mark_copies_in_columns(const Scan& scan, const ScanColumns& columns, std::vector<Fate>& fate) {
  constexpr std::size_t kLookedAt = 8;
  parallel_for(static_cast<std::size_t>(columns.count()), [&](std::size_t c) {
    const std::size_t begin = columns.begin[c], end = columns.begin[c + 1];
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t sample = columns.samples[k];
      if (fate[sample] != kBeside) continue;
      const auto is_copy_of = [&](std::size_t other) {
        return fate[columns.samples[other]] == kInNode &&
               scan.points[columns.samples[other]] == scan.points[sample];
      };
      const auto level = [&](std::size_t other) {
        return columns.row_position[other] == columns.row_position[k];
      };
      bool found = false;
      for (std::size_t n = 1; n <= kLookedAt && !found && k >= begin + n && level(k - n); ++n)
        found = is_copy_of(k - n);
      for (std::size_t n = 1; n <= kLookedAt && !found && k + n < end && level(k + n); ++n)
        found = is_copy_of(k + n);
      if (found) fate[sample] = kCopy;
    }
  });
}

// Returns that no node took: copies of a measured node's point are duplicates, the others extra.
void list_extra(const Scan& scan, const ScanColumns& columns, RangeImage& image) {
  constexpr std::size_t kAtOnce = 1 << 16;
  std::vector<Fate> fate(scan.points.size(), kNoReturn);
  for_blocks(columns.samples.size(), kAtOnce, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) fate[columns.samples[k]] = kBeside;
  });
  for_blocks(image.source.size(), kAtOnce, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (image.source[i] != kNoSource) fate[image.source[i]] = kInNode;
  });
  mark_copies_in_columns(scan, columns, fate);

  SamplesByPoint beside;
  for (std::size_t i = 0; i < fate.size(); ++i)
    if (fate[i] == kBeside) beside.add(scan.points[i], static_cast<std::uint32_t>(i));
  beside.sort();
  for_blocks(fate.size(), kAtOnce, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (fate[i] == kInNode) beside.meet(scan.points[i]);
  });
  beside.for_met([&](std::uint32_t sample) { fate[sample] = kCopy; });
  for (std::size_t i = 0; i < fate.size(); ++i)
    if (fate[i] == kBeside || fate[i] == kCopy)
      (fate[i] == kCopy ? image.duplicates : image.extra).push_back(static_cast<std::uint32_t>(i));
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

RangeImage resample_scan(device::Queue& queue, const Scan& scan, const ResampleOptions& options,
                         GridLayout* layout) {
  if (scan.organised() || scan.range_grid) {
    RangeImage image = arrange_grid(scan, layout);
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
