#include "stages/organised_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/large_vector.hpp"
#include "core/parallel.hpp"
#include "geometry/placed_range_image.hpp"
#include "stages/sweeps.hpp"

namespace hybrid::stages {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kMostSteps = 0.9;  // of a table's steps that must go one way

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
    for_blocks(scan.node.size(), [&](std::size_t, std::size_t first, std::size_t end) {
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
    for_blocks(nodes, [&](std::size_t, std::size_t first, std::size_t end) {
      const auto at = sample_.begin();
      placed += (end - first) -
                static_cast<std::size_t>(std::count(at + static_cast<std::ptrdiff_t>(first),
                                                    at + static_cast<std::ptrdiff_t>(end), kNoSource));
    });
    if (placed == returns) return;
    // Of several returns at a node the first takes it, whichever thread came first.
    for_blocks(scan.node.size(), [&](std::size_t, std::size_t first, std::size_t end) {
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
    for_blocks(scan.node.size(), [&](std::size_t block, std::size_t first, std::size_t end) {
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

  template <typename Body>  // body(block, first, end)
  static void for_blocks(std::size_t count, const Body& body) {
    parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
      body(block, block * kBlock, std::min((block + 1) * kBlock, count));
    });
  }

  const Scan& scan_;
  std::vector<std::uint32_t> sample_;  // per node; empty: the samples are in the grid's order
  std::vector<std::uint32_t> extra_;
};

double median(std::vector<double>& values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Calls take(point) for the returns of a row or column of `count` nodes, of which node(k, sample) finds the
// k-th: for some of them evenly spread, enough for a median, or for all where these hold few returns.
template <typename Node, typename Take>
void for_some_returns(const Scan& scan, int count, const Node& node, const Take& take) {
  constexpr int kSome = 128, kFew = 16;
  const auto visit = [&](int first, int stride) {
    int returns = 0;
    for (int k = first; k < count; k += stride) {
      std::size_t i = 0;
      if (!node(k, i)) continue;
      const Vec3 point = scan.point(i);
      if (!is_return(point)) continue;
      take(point);
      ++returns;
    }
    return returns;
  };
  const int stride = std::max(count / kSome, 1);
  if (visit(stride / 2, stride) >= kFew || stride == 1) return;
  for (int first = 0; first < stride; ++first)
    if (first != stride / 2) visit(first, stride);
}

std::vector<double> row_elevations(const Scan& scan, const GridSamples& grid) {
  std::vector<double> table(static_cast<std::size_t>(scan.grid_rows));
  parallel_for(table.size(), [&](std::size_t row) {
    std::vector<double> values;
    for_some_returns(
        scan, scan.grid_cols,
        [&](int col, std::size_t& i) { return grid.find(static_cast<int>(row), col, i); },
        [&](const Vec3& p) { values.push_back(std::atan2(p.z(), std::hypot(p.x(), p.y()))); });
    table[row] = median(values);
  });
  return table;
}

// Medians of offsets from the column's mean direction, then unwrapped from one measured column to the next.
std::vector<double> column_azimuths(const Scan& scan, const GridSamples& grid) {
  std::vector<double> table(static_cast<std::size_t>(scan.grid_cols));
  parallel_for(table.size(), [&](std::size_t col) {
    Vec2 sum = Vec2::Zero();
    std::vector<double> azimuths;
    for_some_returns(
        scan, scan.grid_rows,
        [&](int row, std::size_t& i) { return grid.find(row, static_cast<int>(col), i); },
        [&](const Vec3& p) {
          sum += p.head<2>() / p.norm();
          azimuths.push_back(std::atan2(p.y(), p.x()));
        });
    const double mean = std::atan2(sum.y(), sum.x());
    for (double& azimuth : azimuths) azimuth = wrapped(azimuth - mean);
    table[col] = mean + median(azimuths);
  });
  double before = NAN;
  for (double& azimuth : table) {
    if (std::isnan(azimuth)) continue;
    if (!std::isnan(before)) azimuth = before + wrapped(azimuth - before);
    before = azimuth;
  }
  return table;
}

// NaN entries by linear interpolation, beyond the ends with the mean step; then whether they go one
// way, as nearly all must: -1 down, 1 up, 0 neither.
int complete(std::vector<double>& table) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (!std::isnan(table[i])) known.push_back(i);
  if (known.size() < 2) return 0;
  const double mean_step =
      (table[known.back()] - table[known.front()]) / static_cast<double>(known.back() - known.front());
  for (std::size_t k = 1; k < known.size(); ++k) {
    const std::size_t a = known[k - 1], b = known[k];
    for (std::size_t i = a + 1; i < b; ++i)
      table[i] = table[a] + (table[b] - table[a]) * static_cast<double>(i - a) / static_cast<double>(b - a);
  }
  const std::size_t first = known.front(), last = known.back();
  for (std::size_t i = 0; i < first; ++i)
    table[i] = table[first] - mean_step * static_cast<double>(first - i);
  for (std::size_t i = last + 1; i < table.size(); ++i)
    table[i] = table[last] + mean_step * static_cast<double>(i - last);
  std::size_t up = 0, down = 0;
  for (std::size_t i = 1; i < table.size(); ++i) {
    up += table[i] > table[i - 1];
    down += table[i] < table[i - 1];
  }
  const std::size_t steps = table.size() - 1;
  if (static_cast<double>(std::max(up, down)) < kMostSteps * static_cast<double>(steps)) return 0;
  if (std::max(up, down) < steps) {  // noise about an even table
    const double from = table.front(), step = (table.back() - from) / static_cast<double>(steps);
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = from + step * static_cast<double>(i);
  }
  return up > down ? 1 : -1;
}

// Median angle between the rays of neighbours `row_step` rows and `col_step` columns apart.
double typical_angle(const Scan& scan, const GridSamples& grid, int row_step, int col_step) {
  std::vector<double> found;
  for (int col = 0; col + col_step < scan.grid_cols; ++col)
    for (int row = 0; row + row_step < scan.grid_rows; ++row) {
      std::size_t a = 0, b = 0;
      if (!grid.find(row, col, a) || !grid.find(row + row_step, col + col_step, b)) continue;
      const Vec3 p = scan.point(a), q = scan.point(b);
      const double angle = std::atan2(p.cross(q).norm(), p.dot(q));
      if (angle > 0) found.push_back(angle);
    }
  const double typical = median(found);
  return std::isnan(typical) ? 0 : typical;
}

std::vector<double> even_table(int count, double step) {
  std::vector<double> table;
  for (int i = 0; i < count; ++i) table.push_back((i - 0.5 * (count - 1)) * step);
  return table;
}

// Rows upside down, columns the other way round, of an image's values.
void flip(std::vector<std::uint32_t>& values, int rows, int cols, bool flip_rows, bool flip_cols) {
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

[[noreturn]] void fail_no_return(const Scan& scan) {
  fail_input("scan {}: expected returns, found none in a grid of {} x {}", scan.name, scan.grid_rows,
             scan.grid_cols);
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

RangeImage arrange_grid(const Scan& scan) {
  const std::size_t nodes =
      static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols);
  if (scan.range_grid) return restore_grid(scan);
  if (!scan.node.empty() && scan.node.size() != scan.points.size())
    fail_input("scan {}: expected a node for each of {} samples, found {}", scan.name, scan.points.size(),
               scan.node.size());
  if (scan.node.empty() && nodes != scan.points.size())
    fail_input("scan {}: expected {} samples for a grid of {} rows x {} columns, found {}", scan.name, nodes,
               scan.grid_rows, scan.grid_cols, scan.points.size());
  std::size_t first = 0;
  while (first < scan.points.size() && !is_return(scan.point(first))) ++first;
  if (first == scan.points.size()) fail_no_return(scan);

  GridSamples grid(scan);
  std::vector<double> elevation = row_elevations(scan, grid), azimuth = column_azimuths(scan, grid);
  const int rows_go = complete(elevation), cols_go = complete(azimuth);
  const double turn = azimuth.back() - azimuth.front();
  const bool even = rows_go == 0 || cols_go == 0 || std::abs(turn) > 1.1 * kTurn;
  if (even) {
    elevation = even_table(scan.grid_rows, -typical_angle(scan, grid, 1, 0));
    azimuth = even_table(scan.grid_cols, typical_angle(scan, grid, 0, 1));
  } else {
    if (rows_go > 0) std::reverse(elevation.begin(), elevation.end());
    if (cols_go < 0) std::reverse(azimuth.begin(), azimuth.end());
  }
  RangeImage image = place(scan, grid, !even && rows_go > 0, !even && cols_go < 0);
  image.extra = grid.extra();
  image.elevation_rad = std::move(elevation);
  image.azimuth_rad = std::move(azimuth);
  image.wraps = !even && is_full_turn(image.azimuth_rad);
  return image;
}

}  // namespace hybrid::stages
