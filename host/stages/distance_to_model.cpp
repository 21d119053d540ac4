#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "geometry/tiles.hpp"
#include "stages/icp.hpp"
#include "stages/icp_pairs.hpp"
#include "stages/proxy_triangles.hpp"

namespace hybrid::stages {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Queries of one tile, dense; a node that was not measured gets a NaN position.
struct TileQueries {
  std::vector<float> values[6];  // x y z nx ny nz

  TileQueries(const RangeImage& image, const PlaneSegmentation& segmentation, const Tile& tile) {
    const auto count = static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.cols);
    for (auto& column : values) column.assign(count, kNan);
    std::size_t k = 0;
    for (int row = tile.row; row < tile.row + tile.rows; ++row)
      for (int col = tile.col; col < tile.col + tile.cols; ++col, ++k) {
        const std::size_t i = image.index(row, col);
        if (image.mask[i] != kMeasured) continue;
        values[0][k] = image.x[i];
        values[1][k] = image.y[i];
        values[2][k] = image.z[i];
        const std::uint32_t label = segmentation.sample_label.empty() ? 0 : segmentation.sample_label[i];
        if (label == 0) continue;
        const Vec3& normal = segmentation.superclusters[label - 1].plane.normal;
        for (int a = 0; a < 3; ++a) values[3 + a][k] = static_cast<float>(normal(a));
      }
  }
};

}  // namespace

std::vector<float> distance_to_model(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const PolygonModel& model,
                                     const Pose& world_from_scan, double normal_deg, int tile_side) {
  if (tile_side < 1)
    fail(ErrorKind::usage, "distance_to_model: expected a tile of at least 1, found {}", tile_side);
  const Vec3 origin = world_from_scan.translation;  // the scanner: all samples lie around it
  const auto records = proxy_triangles(model, origin);
  const auto triangles = queue.array(records);
  Pose local_from_scan = world_from_scan;
  local_from_scan.translation.setZero();
  const int lanes = queue.vector_width();
  const auto& kernel = queue.kernel("closest_point", {{"VW", lanes}});

  std::vector<float> distances(image.count(), kNan);
  for (const Tile& tile : make_tiles(image.rows, image.cols, tile_side)) {
    const TileQueries queries(image, segmentation, tile);
    const std::size_t count = queries.values[0].size();
    device::Array<float> in[6];
    for (int k = 0; k < 6; ++k) in[k] = queue.array(queries.values[k]);
    auto distance = queue.array<float>(count), height = queue.array<float>(count);
    auto near_x = queue.array<float>(count), near_y = queue.array<float>(count),
         near_z = queue.array<float>(count);
    auto triangle = queue.array<std::uint32_t>(count);
    const auto items = (count + static_cast<std::size_t>(lanes) - 1) / static_cast<std::size_t>(lanes);
    queue.launch("closest_point", kernel, device::grid(items),
                 closest_point_params(local_from_scan, 0, normal_deg, count, records.size()), in[0], in[1],
                 in[2], in[3], in[4], in[5], triangles, distance, height, triangle, near_x, near_y, near_z);
    queue.read_rect(distance, distances.data(), static_cast<std::size_t>(image.cols),
                    {static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                     static_cast<std::size_t>(tile.rows), static_cast<std::size_t>(tile.cols)});
  }
  return distances;
}

}  // namespace hybrid::stages
