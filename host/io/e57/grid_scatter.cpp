#include "io/e57/grid_scatter.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "core/large_vector.hpp"
#include "core/parallel.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kSpareNodes = 1 << 12;
constexpr std::uint64_t kGuess_records = 1 << 16;
constexpr std::size_t kStripRanges = 16, kStrip = kStripRanges * E57RecordReader::kRange;
constexpr std::uint64_t kNodesOfScan = Scan::kNoNode;

// Several threads at one node are a file that finish() refuses: what they leave there does not matter.
template <typename T>
void put(std::vector<T>& values, std::size_t node, T value) {
  std::atomic_ref(values[node]).store(value, std::memory_order_relaxed);
}

// Slope's sign of pairs, from sums.
struct Trend {
  double n = 0, x = 0, y = 0, xy = 0;
  void add(double a, double b) { n += 1, x += a, y += b, xy += a * b; }
  double sign() const { return n * xy - x * y; }
};

}  // namespace

// Consecutive records by their place among them.
struct GridScatter::Strip {
  std::uint64_t first = 0;
  std::size_t missing = 0;               // ranges
  std::vector<std::uint32_t> node, row;  // of the image; kNoNode: not to be put
  std::vector<std::array<float, 3>> points;
  std::vector<float> intensity;
  std::vector<std::array<std::uint8_t, 3>> rgb;
  std::vector<std::uint32_t> order, ends;  // while it is sorted

  void start(std::uint64_t from, std::size_t ranges, const ScanColumns& columns) {
    first = from;
    missing = ranges;
    row.resize(kStrip);
    points.resize(kStrip);
    if (columns.intensity) intensity.resize(kStrip);
    if (columns.colour) rgb.resize(kStrip);
    node.assign(kStrip, Scan::kNoNode);
  }

  // The records to put, by rows and in a row in their order; in their order alone where they have more rows
  // than there are records.
  std::span<const std::uint32_t> sorted() {
    std::uint32_t low = Scan::kNoNode, high = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < kStrip; ++i) {
      if (node[i] == Scan::kNoNode) continue;
      low = std::min(low, row[i]);
      high = std::max(high, row[i]);
      ++count;
    }
    order.resize(kStrip);
    const bool by_rows = count > 0 && high - low < kStrip;
    ends.assign(by_rows ? high - low + 2 : 1, 0);
    for (std::size_t i = 0; i < kStrip && by_rows; ++i)
      if (node[i] != Scan::kNoNode) ++ends[row[i] - low + 1];
    for (std::size_t k = 1; k < ends.size(); ++k) ends[k] += ends[k - 1];
    for (std::size_t i = 0; i < kStrip; ++i)
      if (node[i] != Scan::kNoNode) order[ends[by_rows ? row[i] - low : 0]++] = static_cast<std::uint32_t>(i);
    return std::span(order).first(count);
  }
};

// Those that wait for ranges, and others' memory.
struct GridScatter::Strips {
  std::mutex mutex;
  std::map<std::size_t, std::unique_ptr<Strip>> open;
  std::vector<std::unique_ptr<Strip>> done;
};

GridScatter::GridScatter(GridScatter&&) noexcept = default;
GridScatter::~GridScatter() = default;

GridScatter::GridScatter(const ScanColumns& columns, ScanGrid::Bounds row, ScanGrid::Bounds column,
                         std::uint64_t count)
    : columns_(&columns), row_(row), column_(column), strips_(std::make_unique<Strips>()) {
  grid_.image = make_range_image(static_cast<int>(row.extent()), static_cast<int>(column.extent()));
  if (columns.intensity) assign_large(grid_.image.intensity, grid_.image.count(), 0.0f);
  if (columns.colour) grid_.image.rgb.assign(grid_.image.count(), {0, 0, 0});
  grid_.samples = count;
  ranges_.resize((count + E57RecordReader::kRange - 1) / E57RecordReader::kRange);
}

std::optional<GridScatter> GridScatter::of(const E57Scan& scan, const ScanSamples& samples,
                                           const E57RecordReader& reader) {
  const ScanColumns& columns = samples.columns();
  const std::uint64_t count = reader.count();
  if (!columns.row || count == 0 || count >= Scan::kNoNode || !samples.origin().isZero()) return {};
  const auto& fields = scan.points.fields;
  const E57Field &row_field = fields[columns.fields[*columns.row]],
                 &column_field = fields[columns.fields[*columns.column]];
  if (!row_field.is_integer() || !column_field.is_integer()) return {};
  const auto row = ScanGrid::declared(scan.rows, row_field),
             column = ScanGrid::declared(scan.columns, column_field);
  const std::uint64_t most = std::min(2 * count + kSpareNodes, kNodesOfScan);
  if (row.high <= row.low || column.high <= column.low || row.extent() > most / column.extent()) return {};
  GridScatter scatter(columns, row, column, count);
  scatter.guess_directions(samples, reader);
  return scatter;
}

void GridScatter::guess_directions(const ScanSamples& samples, const E57RecordReader& reader) {
  const std::uint64_t count = std::min(kGuess_records, reader.count());
  std::vector<std::array<float, 3>> points(count);
  std::vector<std::array<std::int64_t, 2>> place(count);
  reader.read(columns_->fields, 0, count, [&](const E57Records& records) {
    SampleTally ignored;
    samples.points(records, std::span(points).subspan(records.first, records.count), ignored);
    for (std::size_t i = 0; i < records.count; ++i)
      place[records.first + i] = {records.integers[*columns_->row][i],
                                  records.integers[*columns_->column][i]};
  });
  Trend rising, turning;
  double before = NAN;  // azimuth of the sample before, unwrapped: columns follow each other
  for (std::size_t i = 0; i < count; ++i) {
    const double x = points[i][0], y = points[i][1], z = points[i][2];
    const double level = std::hypot(x, y);
    if (!(level > 0)) continue;
    const double azimuth = std::atan2(y, x);
    if (std::isnan(before)) before = azimuth;
    before += std::remainder(azimuth - before, 2 * std::numbers::pi);
    rising.add(static_cast<double>(place[i][0] - row_.low), std::atan2(z, level));
    turning.add(static_cast<double>(place[i][1] - column_.low), before);
  }
  grid_.rows_reversed = rising.sign() > 0;
  grid_.cols_reversed = turning.sign() < 0;
}

void GridScatter::add(const E57Records& records, std::span<const std::array<float, 3>> points,
                      std::span<const float> intensity, std::span<const std::array<std::uint8_t, 3>> rgb) {
  const std::size_t number = records.first / E57RecordReader::kRange, of_strip = number / kStripRanges;
  Range& range = ranges_[number];
  const std::int64_t *row = records.integers[*columns_->row].data(),
                     *column = records.integers[*columns_->column].data();
  range.row = {row[0], row[0]};
  range.column = {column[0], column[0]};
  for (std::size_t i = 0; i < records.count; ++i) {
    range.row = {std::min(range.row.low, row[i]), std::max(range.row.high, row[i])};
    range.column = {std::min(range.column.low, column[i]), std::max(range.column.high, column[i])};
  }
  range.outside = range.row.low < row_.low || range.row.high > row_.high || range.column.low < column_.low ||
                  range.column.high > column_.high;
  Strip* strip = nullptr;
  {
    const std::lock_guard lock(strips_->mutex);
    std::unique_ptr<Strip>& open = strips_->open[of_strip];
    if (!open) {
      if (strips_->done.empty()) strips_->done.push_back(std::make_unique<Strip>());
      open = std::move(strips_->done.back());
      strips_->done.pop_back();
      open->start(of_strip * kStrip, std::min(kStripRanges, ranges_.size() - of_strip * kStripRanges),
                  *columns_);
    }
    strip = open.get();
  }
  const std::size_t at = records.first - strip->first;
  std::ranges::copy(points, strip->points.begin() + static_cast<std::ptrdiff_t>(at));
  std::ranges::copy(intensity, strip->intensity.begin() + static_cast<std::ptrdiff_t>(at));
  std::ranges::copy(rgb, strip->rgb.begin() + static_cast<std::ptrdiff_t>(at));
  for (std::size_t i = 0; i < records.count && !range.outside; ++i) {
    const double square = Vec3(points[i][0], points[i][1], points[i][2]).squaredNorm();
    if (!std::isfinite(square)) continue;
    ++range.finite;
    if (square == 0) continue;
    ++range.returns;
    const auto r = static_cast<int>(grid_.rows_reversed ? row_.high - row[i] : row[i] - row_.low),
               c = static_cast<int>(grid_.cols_reversed ? column_.high - column[i] : column[i] - column_.low);
    strip->row[at + i] = static_cast<std::uint32_t>(r);
    strip->node[at + i] = static_cast<std::uint32_t>(grid_.image.index(r, c));
  }
  {
    const std::lock_guard lock(strips_->mutex);
    if (--strip->missing > 0) return;
  }
  put_strip(*strip);
  const std::lock_guard lock(strips_->mutex);
  strips_->done.push_back(std::move(strips_->open[of_strip]));
  strips_->open.erase(of_strip);
}

void GridScatter::put_strip(Strip& strip) {
  RangeImage& image = grid_.image;
  // A strip has a few nodes of each row, in lines of the arrays that no other row shares: those of the rows
  // to come are asked for early.
  constexpr std::size_t kAhead = 48;
  const auto order = strip.sorted();
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k + kAhead < order.size()) {
      const std::size_t i = order[k + kAhead], node = strip.node[i];
      __builtin_prefetch(&strip.points[i]);
      for (const std::vector<float>* values : {&image.x, &image.y, &image.z, &image.range_m})
        __builtin_prefetch(values->data() + node, 1);
      __builtin_prefetch(image.source.data() + node, 1);
      __builtin_prefetch(image.mask.data() + node, 1);
      if (!image.intensity.empty()) __builtin_prefetch(image.intensity.data() + node, 1);
    }
    const std::uint32_t i = order[k];
    const std::size_t node = strip.node[i];
    const auto& [x, y, z] = strip.points[i];
    put(image.x, node, x);
    put(image.y, node, y);
    put(image.z, node, z);
    put(image.range_m, node, static_cast<float>(Vec3(x, y, z).norm()));
    put(image.mask, node, std::uint8_t{kMeasured});
    put(image.source, node, static_cast<std::uint32_t>(strip.first + i));
    if (!image.intensity.empty()) put(image.intensity, node, strip.intensity[i]);
    if (image.rgb.empty()) continue;
    for (std::size_t c = 0; c < 3; ++c)
      std::atomic_ref(image.rgb[node][c]).store(strip.rgb[i][c], std::memory_order_relaxed);
  }
}

// In place: rows move towards the front.
void GridScatter::crop(ScanGrid::Bounds row, ScanGrid::Bounds column) {
  RangeImage& image = grid_.image;
  const auto across = static_cast<std::size_t>(image.cols), rows = static_cast<std::size_t>(row.extent()),
             cols = static_cast<std::size_t>(column.extent());
  const auto top = static_cast<std::size_t>(grid_.rows_reversed ? row_.high - row.high : row.low - row_.low);
  const auto left =
      static_cast<std::size_t>(grid_.cols_reversed ? column_.high - column.high : column.low - column_.low);
  const auto cut = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t r = 0; r < rows; ++r) {
      const auto from = values.begin() + static_cast<std::ptrdiff_t>((top + r) * across + left);
      std::copy(from, from + static_cast<std::ptrdiff_t>(cols),
                values.begin() + static_cast<std::ptrdiff_t>(r * cols));
    }
    values.resize(rows * cols);
  };
  cut(image.range_m), cut(image.x), cut(image.y), cut(image.z), cut(image.mask), cut(image.source);
  cut(image.intensity), cut(image.rgb);
  image.rows = static_cast<int>(rows);
  image.cols = static_cast<int>(cols);
  image.elevation_rad.resize(rows);
  image.azimuth_rad.resize(cols);
}

std::optional<GridScan> GridScatter::finish() {
  ScanGrid::Bounds row = ranges_[0].row, column = ranges_[0].column;
  std::uint64_t returns = 0;
  for (const Range& range : ranges_) {
    if (range.outside) return {};
    row = {std::min(row.low, range.row.low), std::max(row.high, range.row.high)};
    column = {std::min(column.low, range.column.low), std::max(column.high, range.column.high)};
    grid_.returns += range.finite;
    returns += range.returns;
  }
  if (row.extent() < 2 || column.extent() < 2 || returns == 0) return {};
  const std::vector<std::uint8_t>& mask = grid_.image.mask;
  if (static_cast<std::uint64_t>(std::ranges::count(mask, std::uint8_t{kMeasured})) != returns) return {};
  if (row.extent() < row_.extent() || column.extent() < column_.extent()) crop(row, column);
  grid_.scan.grid_rows = grid_.image.rows;
  grid_.scan.grid_cols = grid_.image.cols;
  return std::move(grid_);
}

}  // namespace hybrid::io
