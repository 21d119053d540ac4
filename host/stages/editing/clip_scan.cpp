#include "stages/editing/clip_scan.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/scan/node_lookup.hpp"

namespace hybrid::stages {
namespace {

Ring2 area_ring(const std::vector<std::array<int, 2>>& polygon) {
  Ring2 ring;
  for (const auto& [row, col] : polygon) ring.emplace_back(col, row);
  return ring;
}

// Nodes on the border take part.
bool in_area(const Ring2& ring, int row, int col) {
  constexpr double kBorder_px = 1e-6;
  const Vec2 at(col, row);
  return inside(ring, at) || distance_to_border(ring, at) <= kBorder_px;
}

}  // namespace

std::int64_t clip_nodes(const RangeImage& image, const Pose& shape_from_scan, const ClipShape& shape,
                        bool keep_inside, std::vector<std::uint8_t>& clipped) {
  std::atomic<std::int64_t> dropped = 0;
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t row) {
    std::int64_t own = 0;
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(static_cast<int>(row), col);
      if (image.mask[i] != kMeasured || clipped[i]) continue;
      const Vec3 point = shape_from_scan * image.point(i);
      if (holds(shape, point) == keep_inside) continue;
      clipped[i] = 1;
      ++own;
    }
    dropped += own;
  });
  return dropped;
}

std::vector<std::uint8_t> move_area(RangeImage& image, const std::vector<std::array<int, 2>>& polygon,
                                    double by_m) {
  for (const auto& [row, col] : polygon)
    if (row >= image.rows || col >= image.cols)
      fail_input("[{}, {}]: outside the range image of {} rows x {} columns", row, col, image.rows,
                 image.cols);
  const Ring2 ring = area_ring(polygon);
  std::vector<std::uint8_t> moved(image.count(), 0);
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] == kEmpty) continue;
      if (!in_area(ring, row, col)) continue;
      const double range = image.point(i).norm();
      if (!(range + by_m > 0))
        fail_input("row {}, column {}: a range of {:.3f} m cannot change by {} m", row, col, range, by_m);
      const auto factor = static_cast<float>((range + by_m) / range);
      image.x[i] *= factor;
      image.y[i] *= factor;
      image.z[i] *= factor;
      image.range_m[i] += static_cast<float>(by_m);
      moved[i] = image.mask[i] == kMeasured;
    }
  return moved;
}

std::vector<std::size_t> points_in_area(const RangeImage& image, const std::vector<Vec3>& points,
                                        const std::vector<std::array<int, 2>>& polygon) {
  const Ring2 ring = area_ring(polygon);
  const NodeLookup lookup(image);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const auto node = lookup.towards(points[i]); node.within && in_area(ring, node.row, node.col))
      found.push_back(i);
  return found;
}

}  // namespace hybrid::stages
