#include "stages/organised_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/large_vector.hpp"
#include "core/parallel.hpp"
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
    // Of several returns at a node the first takes it, whichever thread comes first.
    std::atomic<bool> all_placed = true;
    parallel_for(
        scan.node.size(),
        [&](std::size_t i) {
          if (!in_grid(i)) {
            if (is_return(scan.point(i))) all_placed.store(false, std::memory_order_relaxed);
            return;
          }
          const std::atomic_ref<std::uint32_t> holder(sample_[scan.node[i]]);
          std::uint32_t held = holder.load(std::memory_order_relaxed);
          if (held == kNoSource &&
              holder.compare_exchange_strong(held, static_cast<std::uint32_t>(i), std::memory_order_relaxed))
            return;
          all_placed.store(false, std::memory_order_relaxed);
          while (i < held && !holder.compare_exchange_weak(held, static_cast<std::uint32_t>(i),
                                                           std::memory_order_relaxed)) {
          }
        },
        kGrain);
    if (all_placed) return;
    std::vector<std::vector<std::uint32_t>> left((scan.node.size() + kGrain - 1) / kGrain);
    parallel_for(left.size(), [&](std::size_t block) {
      for (std::size_t i = block * kGrain; i < std::min((block + 1) * kGrain, scan.node.size()); ++i)
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

 private:
  static constexpr std::size_t kGrain = 1 << 14;

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

void place(const Scan& scan, const GridSamples& grid, bool flip_rows, bool flip_cols, RangeImage& image) {
  if (!scan.intensity.empty()) assign_large(image.intensity, image.count(), 0.0f);
  if (!scan.rgb.empty()) image.rgb.assign(image.count(), {0, 0, 0});
  const auto copy = [&](int row, int col) {
    std::size_t source = 0;
    if (!grid.find(flip_rows ? image.rows - 1 - row : row, flip_cols ? image.cols - 1 - col : col, source))
      return;
    const Vec3 point = scan.point(source);
    const double square = point.squaredNorm();
    if (!std::isfinite(square) || square == 0) return;
    const std::size_t i = image.index(row, col);
    image.x[i] = static_cast<float>(point.x());
    image.y[i] = static_cast<float>(point.y());
    image.z[i] = static_cast<float>(point.z());
    image.range_m[i] = static_cast<float>(std::sqrt(square));
    image.mask[i] = kMeasured;
    image.source[i] = static_cast<std::uint32_t>(source);
    if (!scan.intensity.empty()) image.intensity[i] = scan.intensity[source];
    if (!scan.rgb.empty()) image.rgb[i] = scan.rgb[source];
  };
  // Files go down the columns, images along the rows: bands of rows keep both in the cache.
  constexpr int kBand = 128;
  parallel_for(static_cast<std::size_t>((image.rows + kBand - 1) / kBand), [&](std::size_t band) {
    const int first = static_cast<int>(band) * kBand, end = std::min(first + kBand, image.rows);
    for (int col = 0; col < image.cols; ++col)
      for (int row = first; row < end; ++row) copy(row, col);
  });
}

[[noreturn]] void fail_no_return(const Scan& scan) {
  fail_input("scan {}: expected returns, found none in a grid of {} x {}", scan.name, scan.grid_rows,
             scan.grid_cols);
}

// A range image fed in again: tables, interpolated nodes and samples beside the grid as they were, so that
// what follows gives what it gave the first time.
RangeImage restore_grid(const Scan& scan) {
  const RangeGrid& grid = *scan.range_grid;
  RangeImage image = make_range_image(scan.grid_rows, scan.grid_cols);
  image.elevation_rad = grid.elevation_rad;
  image.azimuth_rad = grid.azimuth_rad;
  image.wraps = grid.wraps;
  place(scan, GridSamples(scan), false, false, image);
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

  const GridSamples grid(scan);
  RangeImage image = make_range_image(scan.grid_rows, scan.grid_cols);
  image.extra = grid.extra();
  image.elevation_rad = row_elevations(scan, grid);
  image.azimuth_rad = column_azimuths(scan, grid);
  const int rows_go = complete(image.elevation_rad), cols_go = complete(image.azimuth_rad);
  const double turn = image.azimuth_rad.back() - image.azimuth_rad.front();
  if (rows_go == 0 || cols_go == 0 || std::abs(turn) > 1.1 * kTurn) {
    image.elevation_rad = even_table(image.rows, -typical_angle(scan, grid, 1, 0));
    image.azimuth_rad = even_table(image.cols, typical_angle(scan, grid, 0, 1));
    place(scan, grid, false, false, image);
    return image;
  }
  if (rows_go > 0) std::reverse(image.elevation_rad.begin(), image.elevation_rad.end());
  if (cols_go < 0) std::reverse(image.azimuth_rad.begin(), image.azimuth_rad.end());
  image.wraps = is_full_turn(image.azimuth_rad);
  place(scan, grid, rows_go > 0, cols_go < 0, image);
  return image;
}

}  // namespace hybrid::stages
