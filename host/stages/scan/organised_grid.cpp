#include "stages/scan/organised_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/error.hpp"
#include "core/large_vector.hpp"
#include "core/parallel_blocks.hpp"
#include "geometry/placed_range_image.hpp"
#include "stages/scan/columns.hpp"
#include "stages/scan/grid_layout.hpp"

namespace hybrid::stages {
namespace {

bool is_return(const Vec3& point) {
  const double square = point.squaredNorm();
  return std::isfinite(square) && square != 0;
}

// Which sample is at a node.
class GridSamples {
 public:
  explicit GridSamples(const Scan& scan) : scan_(scan) {
    if (scan.node.empty()) return;  // the samples are in the grid's order
    const std::size_t nodes =
        static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols);
    assign_large(sample_, nodes, kNoSource);
    const auto in_grid = [&](std::size_t i) { return scan.node[i] < nodes && is_return(scan.point(i)); };
    std::atomic<std::size_t> returns = 0, placed = 0;
    for_blocks(scan.node.size(), kBlock, [&](std::size_t, std::size_t first, std::size_t end) {
      std::size_t found = 0;
      for (std::size_t i = first; i < end; ++i) {
        if (!is_return(scan.point(i))) continue;
        ++found;
        if (scan.node[i] < nodes)
          std::atomic_ref(sample_[scan.node[i]])
              .store(static_cast<std::uint32_t>(i), std::memory_order_relaxed);
      }
      returns += found;
    });
    for_blocks(nodes, kBlock, [&](std::size_t, std::size_t first, std::size_t end) {
      const auto at = sample_.begin();
      placed += (end - first) -
                static_cast<std::size_t>(std::count(at + static_cast<std::ptrdiff_t>(first),
                                                    at + static_cast<std::ptrdiff_t>(end), kNoSource));
    });
    if (placed == returns) return;
    // Of several returns at a node the first takes it, whichever thread came first.
    for_blocks(scan.node.size(), kBlock, [&](std::size_t, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        if (!in_grid(i)) continue;
        const std::atomic_ref<std::uint32_t> holder(sample_[scan.node[i]]);
        std::uint32_t held = holder.load(std::memory_order_relaxed);
        while (i < held && !holder.compare_exchange_weak(held, static_cast<std::uint32_t>(i),
                                                         std::memory_order_relaxed)) {
        }
      }
    });
    std::vector<std::vector<std::uint32_t>> left((scan.node.size() + kBlock - 1) / kBlock);
    for_blocks(scan.node.size(), kBlock, [&](std::size_t block, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i)
        if (in_grid(i) ? sample_[scan.node[i]] != i : is_return(scan.point(i)))
          left[block].push_back(static_cast<std::uint32_t>(i));
    });
    for (const auto& block : left) extra_.insert(extra_.end(), block.begin(), block.end());
  }
  // False: the node has no sample. A sample need not be a return.
  bool find(int row, int col, std::size_t& sample) const {
    if (sample_.empty()) {
      sample = scan_.grid_index(row, col);
      return true;
    }
    const std::uint32_t found =
        sample_[static_cast<std::size_t>(row) * static_cast<std::size_t>(scan_.grid_cols) +
                static_cast<std::size_t>(col)];
    sample = found;
    return found != kNoSource;
  }
  // Returns that have no node: further ones of a node, and those outside the grid; ascending.
  const std::vector<std::uint32_t>& extra() const { return extra_; }
  // The table itself, empty where the samples are in the grid's order: as it holds returns only, it is the
  // image's `source` but for its flips. Nothing can be found here afterwards.
  std::vector<std::uint32_t> release() { return std::move(sample_); }

 private:
  static constexpr std::size_t kBlock = 1 << 14;

  const Scan& scan_;
  std::vector<std::uint32_t> sample_;  // per node; empty: the samples are in the grid's order
  std::vector<std::uint32_t> extra_;
};

// The samples where the file's grid has them.
class ScanNodes : public NodePoints {
 public:
  ScanNodes(const Scan& scan, const GridSamples& grid)
      : NodePoints(scan.grid_rows, scan.grid_cols), scan_(scan), grid_(grid) {}
  bool find(int row, int col, Vec3& point) const override {
    std::size_t i = 0;
    if (!grid_.find(row, col, i)) return false;
    point = scan_.point(i);
    return is_return(point);
  }

 private:
  const Scan& scan_;
  const GridSamples& grid_;
};

// The same of an image whose first row, or column, may be the file's last.
class ImageNodes : public NodePoints {
 public:
  ImageNodes(const RangeImage& image, bool rows_reversed, bool cols_reversed)
      : NodePoints(image.rows, image.cols), image_(image), rows_(rows_reversed), cols_(cols_reversed) {}
  bool find(int row, int col, Vec3& point) const override {
    const std::size_t i = image_.index(rows_ ? rows() - 1 - row : row, cols_ ? cols() - 1 - col : col);
    if (image_.mask[i] != kMeasured) return false;
    point = image_.point(i);
    return true;
  }

 private:
  const RangeImage& image_;
  bool rows_, cols_;
};

void take_tables(GridTables tables, RangeImage& image) {
  image.elevation_rad = std::move(tables.elevation_rad);
  image.azimuth_rad = std::move(tables.azimuth_rad);
  image.wraps = !tables.even && is_full_turn(image.azimuth_rad);
}

// Rows upside down, columns the other way round, of an image's values.
template <typename T>
void flip(std::vector<T>& values, int rows, int cols, bool flip_rows, bool flip_cols) {
  if (values.empty()) return;
  const auto row_at = [&](std::size_t row) {
    return values.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(cols));
  };
  const auto count = static_cast<std::size_t>(rows);
  if (flip_rows)
    parallel_for(count / 2, [&](std::size_t row) {
      std::swap_ranges(row_at(row), row_at(row + 1), row_at(count - 1 - row));
    });
  if (flip_cols) parallel_for(count, [&](std::size_t row) { std::reverse(row_at(row), row_at(row + 1)); });
}

// The scan's samples as an image with its tables empty.
RangeImage place(const Scan& scan, GridSamples& grid, bool flip_rows, bool flip_cols) {
  std::vector<std::uint32_t> sources = grid.release();
  const bool in_order = sources.empty();
  if (!in_order) flip(sources, scan.grid_rows, scan.grid_cols, flip_rows, flip_cols);
  RangeImage image = make_range_image(scan.grid_rows, scan.grid_cols, std::move(sources));
  if (!scan.intensity.empty()) assign_large(image.intensity, image.count(), 0.0f);
  if (!scan.rgb.empty()) image.rgb.assign(image.count(), {0, 0, 0});
  const auto copy = [&](int row, int col) {
    const std::size_t i = image.index(row, col);
    const std::size_t source = in_order ? scan.grid_index(flip_rows ? image.rows - 1 - row : row,
                                                          flip_cols ? image.cols - 1 - col : col)
                                        : image.source[i];
    if (!in_order && source == kNoSource) return;
    const Vec3 point = scan.point(source);
    const double square = point.squaredNorm();
    if (!std::isfinite(square) || square == 0) return;
    image.x[i] = static_cast<float>(point.x());
    image.y[i] = static_cast<float>(point.y());
    image.z[i] = static_cast<float>(point.z());
    image.range_m[i] = static_cast<float>(std::sqrt(square));
    image.mask[i] = kMeasured;
    image.source[i] = static_cast<std::uint32_t>(source);
    if (!scan.intensity.empty()) image.intensity[i] = scan.intensity[source];
    if (!scan.rgb.empty()) image.rgb[i] = scan.rgb[source];
  };
  // Files go down the columns, images along the rows: in blocks of a cache line's width both stay in the
  // cache.
  constexpr int kHigh = 128, kWide = 16;
  parallel_for(static_cast<std::size_t>((image.rows + kHigh - 1) / kHigh), [&](std::size_t band) {
    const int first = static_cast<int>(band) * kHigh, end = std::min(first + kHigh, image.rows);
    for (int left = 0; left < image.cols; left += kWide)
      for (int row = first; row < end; ++row)
        for (int col = left; col < std::min(left + kWide, image.cols); ++col) copy(row, col);
  });
  return image;
}

// Puts the nodes of an image, which lies as its file's grid does, where the layout has them.
void lay_out(const LaidOutGrid& grid, RangeImage& image) {
  RangeImage laid = make_range_image(grid.rows, grid.cols);
  if (!image.intensity.empty()) laid.intensity.assign(laid.count(), 0.0f);
  if (!image.rgb.empty()) laid.rgb.assign(laid.count(), {0, 0, 0});
  parallel_for(static_cast<std::size_t>(laid.rows), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int col = 0; col < laid.cols; ++col) {
      const auto from = grid.from(grid.tables.flip_rows ? laid.rows - 1 - row : row,
                                  grid.tables.flip_cols ? laid.cols - 1 - col : col);
      if (from.row < 0) continue;
      const std::size_t to = laid.index(row, col), i = image.index(from.row, from.col);
      const auto copy = [&](const auto& values, auto& into) {
        if (!values.empty()) into[to] = values[i];
      };
      copy(image.range_m, laid.range_m);
      copy(image.x, laid.x);
      copy(image.y, laid.y);
      copy(image.z, laid.z);
      copy(image.mask, laid.mask);
      copy(image.source, laid.source);
      copy(image.intensity, laid.intensity);
      copy(image.rgb, laid.rgb);
    }
  });
  laid.extra = std::move(image.extra);
  laid.duplicates = std::move(image.duplicates);
  image = std::move(laid);
}

[[noreturn]] void fail_no_return(const Scan& scan) {
  fail_without_returns(fmt::format("in a grid of {} x {}", scan.grid_rows, scan.grid_cols));
}

// A range image fed in again: tables, interpolated nodes and samples beside the grid as they were, so that
// what follows gives what it gave the first time.
RangeImage restore_grid(const Scan& scan) {
  const RangeGrid& grid = *scan.range_grid;
  GridSamples samples(scan);
  RangeImage image = place(scan, samples, false, false);
  image.elevation_rad = grid.elevation_rad;
  image.azimuth_rad = grid.azimuth_rad;
  image.wraps = grid.wraps;
  for (std::size_t k = 0; k < grid.interpolated.size(); ++k) {
    const std::size_t i = grid.interpolated[k];
    image.mask[i] = kInterpolated;
    image.x[i] = grid.interpolated_point[k][0];
    image.y[i] = grid.interpolated_point[k][1];
    image.z[i] = grid.interpolated_point[k][2];
    image.range_m[i] = grid.interpolated_point[k][3];
  }
  for (std::size_t i = image.count(); i < scan.points.size(); ++i)
    if (scan.point(i).allFinite()) image.extra.push_back(static_cast<std::uint32_t>(i));
  if (image.extra.empty() && std::find(image.mask.begin(), image.mask.end(), kMeasured) == image.mask.end())
    fail_no_return(scan);
  return image;
}

}  // namespace

RangeImage arrange_grid(const Scan& scan, GridLayout* layout) {
  const std::size_t nodes =
      static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols);
  if (scan.range_grid) return restore_grid(scan);
  if (!scan.node.empty() && scan.node.size() != scan.points.size())
    fail_input("expected a node for each of {} samples, found {}", scan.points.size(), scan.node.size());
  if (scan.node.empty() && nodes != scan.points.size())
    fail_input("expected {} samples for a grid of {} rows x {} columns, found {}", nodes, scan.grid_rows,
               scan.grid_cols, scan.points.size());
  std::size_t first = 0;
  while (first < scan.points.size() && !is_return(scan.point(first))) ++first;
  if (first == scan.points.size()) fail_no_return(scan);

  GridSamples samples(scan);
  LaidOutGrid grid =
      lay_out_grid(ScanNodes(scan, samples), scan.node.empty() ? SampleOrder(scan.row_by_row) : std::nullopt);
  const bool relaid = static_cast<bool>(grid.from);
  RangeImage image = place(scan, samples, !relaid && grid.tables.flip_rows, !relaid && grid.tables.flip_cols);
  image.extra = samples.extra();
  if (relaid) lay_out(grid, image);
  take_tables(std::move(grid.tables), image);
  if (layout) *layout = grid.layout;
  return image;
}

GridLayout orient_grid(RangeImage& image, bool rows_reversed, bool cols_reversed) {
  LaidOutGrid grid = lay_out_grid(ImageNodes(image, rows_reversed, cols_reversed), std::nullopt);
  const bool relaid = static_cast<bool>(grid.from);
  const bool rows = (!relaid && grid.tables.flip_rows) != rows_reversed,
             cols = (!relaid && grid.tables.flip_cols) != cols_reversed;
  if (rows || cols) {
    const auto turn = [&](auto&... values) { (flip(values, image.rows, image.cols, rows, cols), ...); };
    turn(image.range_m, image.x, image.y, image.z, image.mask, image.source, image.intensity, image.rgb);
  }
  if (relaid) lay_out(grid, image);
  take_tables(std::move(grid.tables), image);
  return grid.layout;
}

}  // namespace hybrid::stages
