#include "stages/registration/scan_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/median.hpp"
#include "core/parallel.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostNodes = 1'000'000;
constexpr double kOnItsNode = 0.9;  // share of the samples that a grid's tables must lead back to

// As kernels/lib/range_grid.h has them.
double elevation_measure(double angle) {
  return std::sin(angle) / (std::abs(std::sin(angle)) + std::cos(angle));
}
double azimuth_measure(double angle) {
  const double x = std::cos(angle), y = std::sin(angle), quarter = y / (std::abs(x) + std::abs(y));
  const double turns = std::round((angle - std::atan2(y, x)) / (2 * std::numbers::pi));
  return 4 * turns + (x >= 0 ? quarter : y >= 0 ? 2 - quarter : -2 - quarter);
}

// Middles between neighbours, and half a step beyond the ends; of a single one half of `fallback`.
template <typename Measure>
std::vector<float> edges(const std::vector<double>& values, double fallback, const Measure& measure) {
  const std::size_t n = values.size();
  if (n == 0) return {0};
  const double first = n > 1 ? values[1] - values[0] : fallback,
               last = n > 1 ? values[n - 1] - values[n - 2] : first;
  std::vector<float> found = {static_cast<float>(measure(values[0] - first / 2))};
  for (std::size_t i = 1; i < n; ++i)
    found.push_back(static_cast<float>(measure((values[i - 1] + values[i]) / 2)));
  found.push_back(static_cast<float>(measure(values[n - 1] + last / 2)));
  return found;
}

constexpr double kLoneStep = 1e-3;  // of a grid of one row or column

float as_is(double value) {
  return static_cast<float>(value);
}

// Every stride-th row and column of the image.
struct Thinned {
  const RangeImage& image;
  int stride, rows, cols;

  explicit Thinned(const RangeImage& whole) : image(whole) {
    stride = 1;
    const auto nodes = [&](int s) {
      return static_cast<std::size_t>((image.rows + s - 1) / s) *
             static_cast<std::size_t>((image.cols + s - 1) / s);
    };
    while (nodes(stride) > kMostNodes) ++stride;
    rows = (image.rows + stride - 1) / stride;
    cols = (image.cols + stride - 1) / stride;
  }
  std::vector<double> rows_of(const std::vector<double>& table) const { return every(table, rows); }
  std::vector<double> cols_of(const std::vector<double>& table) const { return every(table, cols); }

 private:
  std::vector<double> every(const std::vector<double>& table, int count) const {
    std::vector<double> some;
    for (int i = 0; i < count; ++i) some.push_back(table[static_cast<std::size_t>(i * stride)]);
    return some;
  }
};

// Rows and columns of a pinhole that looks along x of its frame: z / x, and -y / x, of which columns go one
// way or, as those of images whose azimuth increases, the other.
struct PinholeTables {
  std::vector<double> row, col;
  bool mirrored() const { return col.front() > col.back(); }
};

// Columns in the order in which -y / x increases.
std::vector<double> ascending(std::vector<double> col) {
  if (col.front() > col.back()) std::reverse(col.begin(), col.end());
  return col;
}

// A straight line through (index, value); nothing through fewer than two.
std::optional<std::vector<double>> line_through(const std::vector<std::pair<int, double>>& points,
                                                int count) {
  if (points.size() < 2) return std::nullopt;
  double i0 = 0, v0 = 0, ii = 0, iv = 0;
  for (const auto& [i, v] : points) i0 += i, v0 += v;
  i0 /= static_cast<double>(points.size()), v0 /= static_cast<double>(points.size());
  for (const auto& [i, v] : points) ii += (i - i0) * (i - i0), iv += (i - i0) * (v - v0);
  std::vector<double> table;
  for (int i = 0; i < count; ++i) table.push_back(v0 + iv / ii * (i - i0));
  return table;
}

std::optional<PinholeTables> pinhole_tables(const RangeImage& image, const Pose& grid_from_scan) {
  std::vector<std::vector<double>> of_row(static_cast<std::size_t>(image.rows)),
      of_col(static_cast<std::size_t>(image.cols));
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] != kMeasured) continue;
      const Vec3 p = grid_from_scan * image.point(i);
      if (!(p.x() > 0)) return std::nullopt;
      of_row[static_cast<std::size_t>(row)].push_back(p.z() / p.x());
      of_col[static_cast<std::size_t>(col)].push_back(-p.y() / p.x());
    }
  const auto line = [](std::vector<std::vector<double>>& values) {
    std::vector<std::pair<int, double>> medians;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!values[k].empty()) medians.emplace_back(static_cast<int>(k), median(values[k]));
    return line_through(medians, static_cast<int>(values.size()));
  };
  auto row = line(of_row), col = line(of_col);
  if (!row || !col || !(row->front() > row->back()) || col->front() == col->back()) return std::nullopt;
  return PinholeTables{std::move(*row), std::move(*col)};
}

// Share of the samples whose own node these edges lead to, give or take one.
template <typename Row, typename Col>
double share_on_its_node(const RangeImage& image, const Pose& grid_from_scan, const std::vector<float>& rows,
                         const std::vector<float>& cols, bool mirrored, const Row& row_measure,
                         const Col& col_measure) {
  const auto stride = static_cast<std::size_t>(1 + image.count() / 20000);
  std::size_t on = 0, all = 0;
  for (std::size_t i = 0; i < image.count(); i += stride) {
    if (image.mask[i] != kMeasured) continue;
    const Vec3 p = grid_from_scan * image.point(i);
    const auto row =
        std::upper_bound(rows.begin(), rows.end(), row_measure(p), std::greater<>()) - rows.begin() - 1;
    const auto col = std::upper_bound(cols.begin(), cols.end(), col_measure(p)) - cols.begin() - 1;
    const auto own_row = static_cast<std::ptrdiff_t>(i) / image.cols,
               along = static_cast<std::ptrdiff_t>(i) % image.cols,
               own_col = mirrored ? image.cols - 1 - along : along;
    const auto apart = std::abs(col - own_col);
    on += std::abs(row - own_row) <= 1 && (apart <= 1 || (image.wraps && apart >= image.cols - 2));
    ++all;
  }
  return all > 0 ? static_cast<double>(on) / static_cast<double>(all) : 0;
}

bool spherical_grid(const RangeImage& image) {
  const auto rows = row_edges(image.elevation_rad, GRID_SPHERICAL),
             cols = col_edges(image.azimuth_rad, GRID_SPHERICAL);
  return share_on_its_node(
             image, Pose(), rows, cols, false,
             [](const Vec3& p) { return elevation_measure(std::atan2(p.z(), std::hypot(p.x(), p.y()))); },
             [&](const Vec3& p) {
               const double measure = azimuth_measure(std::atan2(p.y(), p.x()));
               return measure + 4 * std::ceil((static_cast<double>(cols[0]) - measure) / 4);
             }) >= kOnItsNode;
}

bool pinhole_grid(const RangeImage& image, const PinholeTables& tables, const Pose& grid_from_scan) {
  return share_on_its_node(
             image, grid_from_scan, row_edges(tables.row, GRID_PINHOLE),
             col_edges(ascending(tables.col), GRID_PINHOLE), tables.mirrored(),
             [](const Vec3& p) { return p.z() / p.x(); },
             [](const Vec3& p) { return -p.y() / p.x(); }) >= kOnItsNode;
}

// Frames of pinhole images: this program's depth images look along x, others along z, y down.
std::vector<Pose> pinhole_frames() {
  Mat3 along_z;
  along_z << 0, 0, 1,  //
      -1, 0, 0,        //
      0, -1, 0;
  return {Pose(), Pose{1, Eigen::Quaterniond(along_z), Vec3::Zero()}};
}

double mean_step(const std::vector<double>& table) {
  return table.size() > 1 ? std::abs(table.back() - table.front()) / static_cast<double>(table.size() - 1)
                          : kLoneStep;
}

}  // namespace

std::vector<float> row_edges(const std::vector<double>& rows, std::uint32_t lens) {
  if (lens == GRID_PINHOLE) return edges(rows, -kLoneStep, as_is);
  return edges(rows, -kLoneStep, [](double angle) {
    return elevation_measure(std::clamp(angle, -std::numbers::pi / 2, std::numbers::pi / 2));
  });
}

std::vector<float> col_edges(const std::vector<double>& cols, std::uint32_t lens) {
  if (lens == GRID_PINHOLE) return edges(cols, kLoneStep, as_is);
  return edges(cols, kLoneStep, azimuth_measure);
}

SamplePlace sample_place(const Pose& grid_from_queries) {
  const Mat3 linear = grid_from_queries.scale * grid_from_queries.rotation.toRotationMatrix();
  SamplePlace place{};
  for (int k = 0; k < 9; ++k) place.linear[k] = static_cast<float>(linear(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) place.translation[k] = static_cast<float>(grid_from_queries.translation(k));
  return place;
}

EdgeBins edge_bins(const std::vector<float>& edges, float sign) {
  EdgeBins bins;
  const float first = sign * edges.front(), span = sign * edges.back() - first;
  if (span > 0) bins.per_unit = static_cast<float>(GRID_BINS) / span;
  bins.starts.assign(GRID_BINS + 1, 0);
  for (const float edge : edges) {
    const float at = (sign * edge - first) * bins.per_unit;
    const float bin = at > 0 ? std::min(at, GRID_BINS - 1.0f) : 0;
    ++bins.starts[static_cast<std::size_t>(bin) + 1];
  }
  std::partial_sum(bins.starts.begin(), bins.starts.end(), bins.starts.begin());
  return bins;
}

std::vector<float> block_ranges(const std::vector<float>& ranges, int rows, int cols) {
  constexpr int kSide = CLOSEST_SAMPLE_BLOCK;
  const auto down = static_cast<std::size_t>((rows + kSide - 1) / kSide),
             across = static_cast<std::size_t>((cols + kSide - 1) / kSide);
  std::vector<float> blocks(2 * down * across);
  parallel_for(down, [&](std::size_t block_row) {
    float* least_and_largest = &blocks[2 * block_row * across];
    for (std::size_t k = 0; k < across; ++k) {
      least_and_largest[2 * k] = std::numeric_limits<float>::infinity();
      least_and_largest[2 * k + 1] = -std::numeric_limits<float>::infinity();
    }
    const int first = static_cast<int>(block_row) * kSide;
    for (int row = first; row < std::min(first + kSide, rows); ++row)
      for (int col = 0; col < cols; ++col) {
        const float range = ranges[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) +
                                   static_cast<std::size_t>(col)];
        float* block = least_and_largest + 2 * (col / kSide);
        if (range < block[0]) block[0] = range;
        if (range > block[1]) block[1] = range;
      }
  });
  return blocks;
}

SampleAnswers::SampleAnswers(device::Queue& queue, std::size_t queries, std::size_t places)
    : distance(queue.array<float>(queries * places)),
      height(queue.array<float>(queries * places)),
      normal_x(queue.array<float>(queries * places)),
      normal_y(queue.array<float>(queries * places)),
      normal_z(queue.array<float>(queries * places)),
      clearance(queue.array<float>(queries * places)) {}

ScanSurface::ScanSurface(device::Queue& queue, const RangeImage& image, const PlaneSegmentation& segmentation,
                         const std::vector<std::uint8_t>& stray)
    : queue_(queue) {
  if (image.rows < 1 || image.cols < 1) return;
  const Thinned thinned(image);
  std::vector<double> row, col;
  bool mirrored = false;
  if (spherical_grid(image)) {
    known_ = true;
    params_.lens = GRID_SPHERICAL;
    params_.wraps = image.wraps;
    row = thinned.rows_of(image.elevation_rad), col = thinned.cols_of(image.azimuth_rad);
  } else {
    for (const Pose& frame : pinhole_frames()) {
      const auto tables = pinhole_tables(image, frame);
      if (!tables || !pinhole_grid(image, *tables, frame)) continue;
      known_ = true;
      params_.lens = GRID_PINHOLE;
      grid_from_scan_ = frame;
      mirrored = tables->mirrored();
      row = thinned.rows_of(tables->row), col = ascending(thinned.cols_of(tables->col));
      break;
    }
  }
  if (!known_) return;
  const auto between_rows = row_edges(row, params_.lens), between_cols = col_edges(col, params_.lens);
  const EdgeBins row_bins = edge_bins(between_rows, -1), col_bins = edge_bins(between_cols, 1);
  row_edges_ = queue.array(between_rows);
  col_edges_ = queue.array(between_cols);
  row_starts_ = queue.array(row_bins.starts);
  col_starts_ = queue.array(col_bins.starts);
  params_.row_bins = row_bins.per_unit;
  params_.col_bins = col_bins.per_unit;
  params_.rows = static_cast<std::uint32_t>(thinned.rows);
  params_.cols = static_cast<std::uint32_t>(thinned.cols);
  params_.row_step = static_cast<float>(mean_step(row));
  params_.col_step = static_cast<float>(mean_step(col));
  spacing_ = std::hypot(mean_step(row), mean_step(col));

  const auto count = static_cast<std::size_t>(thinned.rows) * static_cast<std::size_t>(thinned.cols);
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> ranges(count, kNone), points(3 * count, kNone), normals(3 * count, kNone);
  const SampleSurfaces surfaces(image, segmentation);
  parallel_for(static_cast<std::size_t>(thinned.rows), [&](std::size_t r) {
    for (int c = 0; c < thinned.cols; ++c) {
      const int whole_row = static_cast<int>(r) * thinned.stride, whole_col = c * thinned.stride;
      const std::size_t i = image.index(whole_row, whole_col);
      if (image.mask[i] != kMeasured || (!stray.empty() && stray[i] != 0)) continue;
      const Vec3 normal = grid_from_scan_ * surfaces.at(whole_row, whole_col).normal;
      Vec3 point = image.point(i);
      if (const std::uint32_t label = segmentation.sample_label[i]; label > 0) {
        const Plane& plane = segmentation.superclusters[label - 1].plane;
        point -= plane.distance(point) * plane.normal;
      }
      point = grid_from_scan_ * point;
      const std::size_t node = r * static_cast<std::size_t>(thinned.cols) +
                               static_cast<std::size_t>(mirrored ? thinned.cols - 1 - c : c);
      ranges[node] = static_cast<float>(point.norm());
      Eigen::Vector3f::Map(&points[3 * node]) = point.cast<float>();
      if (!normal.isZero()) Eigen::Vector3f::Map(&normals[3 * node]) = normal.cast<float>();
    }
  });
  ranges_ = queue.array(ranges);
  block_ranges_ = queue.array(block_ranges(ranges, thinned.rows, thinned.cols));
  points_ = queue.array(points);
  normals_ = queue.array(normals);
}

void ScanSurface::find(const SearchQueries& queries, std::span<const Pose> scan_from_queries, double gate_m,
                       double normal_deg, SampleAnswers& out) const {
  SamplePlaces places{};
  for (std::size_t p = 0; p < scan_from_queries.size(); ++p)
    places.each[p] = sample_place(grid_from_scan_ * scan_from_queries[p]);
  ClosestSampleParams params = params_;
  params.gate = static_cast<float>(gate_m);
  params.reach = static_cast<float>(spacing_);
  params.min_facing = static_cast<float>(grid_from_scan_.scale * scan_from_queries[0].scale *
                                         std::cos(normal_deg * std::numbers::pi / 180));
  params.queries = static_cast<std::uint32_t>(queries.count);
  queue_.launch("closest_sample", queue_.kernel("closest_sample"),
                device::grid(queries.count, scan_from_queries.size()), params, places, queries.x, queries.y,
                queries.z, queries.nx, queries.ny, queries.nz, ranges_, points_, normals_, block_ranges_,
                row_edges_, col_edges_, row_starts_, col_starts_, out.distance, out.height, out.normal_x,
                out.normal_y, out.normal_z, out.clearance);
}

}  // namespace hybrid::stages
