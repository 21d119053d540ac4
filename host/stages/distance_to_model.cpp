#include <Eigen/Geometry>
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

constexpr int kGatedTile = 128;  // small, so that few triangles are near it

// Queries of one tile, dense; a node that was not measured, or is not wanted, gets a NaN position.
struct TileQueries {
  std::vector<float> values[6];  // x y z nx ny nz
  Eigen::AlignedBox3d box;       // of the positions, scan frame

  TileQueries(const RangeImage& image, const PlaneSegmentation& segmentation, const Tile& tile,
              const std::vector<std::uint8_t>* wanted) {
    const auto count = static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.cols);
    for (auto& column : values) column.assign(count, kNan);
    std::size_t k = 0;
    for (int row = tile.row; row < tile.row + tile.rows; ++row)
      for (int col = tile.col; col < tile.col + tile.cols; ++col, ++k) {
        const std::size_t i = image.index(row, col);
        if (image.mask[i] != kMeasured || (wanted != nullptr && (*wanted)[i] == 0)) continue;
        box.extend(image.point(i));
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

Eigen::AlignedBox3d box_of(const ProxyTriangle& t) {
  const Vec3 a(t.a[0], t.a[1], t.a[2]);
  Eigen::AlignedBox3d box(a);
  box.extend(a + Vec3(t.ab[0], t.ab[1], t.ab[2]));
  box.extend(a + Vec3(t.ac[0], t.ac[1], t.ac[2]));
  return box;
}

// Those that may lie within the gate of a query, in their order.
std::vector<ProxyTriangle> triangles_near(const std::vector<ProxyTriangle>& triangles,
                                          const std::vector<Eigen::AlignedBox3d>& boxes,
                                          const TileQueries& queries, const Pose& local_from_scan,
                                          double gate_m) {
  Eigen::AlignedBox3d reach;
  for (int corner = 0; corner < 8; ++corner)
    reach.extend(local_from_scan *
                 Vec3(queries.box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  // Double the gate: the device's float positions may be off by a rounding.
  const Eigen::AlignedBox3d grown(reach.min().array() - 2 * gate_m, reach.max().array() + 2 * gate_m);
  std::vector<ProxyTriangle> near;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (grown.intersects(boxes[i])) near.push_back(triangles[i]);
  return near;
}

class Distances {
 public:
  Distances(device::Queue& queue, const PolygonModel& model, const Pose& world_from_scan, double normal_deg)
      : queue_(queue),
        kernel_(queue.kernel("closest_point", {{"VW", queue.vector_width()}})),
        local_from_scan_(world_from_scan),
        normal_deg_(normal_deg),
        triangles_(proxy_triangles(model, world_from_scan.translation)) {
    local_from_scan_.translation.setZero();
  }

  const Pose& local_from_scan() const { return local_from_scan_; }
  const std::vector<ProxyTriangle>& triangles() const { return triangles_; }

  // Of one tile, into the image's nodes.
  void measure(const TileQueries& queries, const device::Array<ProxyTriangle>& near, std::size_t near_count,
               double gate_m, const Tile& tile, int image_cols, std::vector<float>& distances,
               std::vector<float>* heights = nullptr) {
    const std::size_t count = queries.values[0].size();
    const auto lanes = static_cast<std::size_t>(queue_.vector_width());
    device::Array<float> in[6];
    for (int k = 0; k < 6; ++k) in[k] = queue_.array(queries.values[k]);
    auto distance = queue_.array<float>(count), height = queue_.array<float>(count);
    auto near_x = queue_.array<float>(count), near_y = queue_.array<float>(count),
         near_z = queue_.array<float>(count);
    auto triangle = queue_.array<std::uint32_t>(count);
    queue_.launch("closest_point", kernel_, device::grid((count + lanes - 1) / lanes),
                  closest_point_params(local_from_scan_, gate_m, normal_deg_, count, near_count), in[0],
                  in[1], in[2], in[3], in[4], in[5], near, distance, height, triangle, near_x, near_y,
                  near_z);
    const auto read = [&](const device::Array<float>& from, std::vector<float>& to) {
      queue_.read_rect(from, to.data(), static_cast<std::size_t>(image_cols),
                       {static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                        static_cast<std::size_t>(tile.rows), static_cast<std::size_t>(tile.cols)});
    };
    read(distance, distances);
    if (heights != nullptr) read(height, *heights);
  }

 private:
  device::Queue& queue_;
  const device::Kernel& kernel_;
  Pose local_from_scan_;  // world axes, origin at the scanner: all samples lie around it
  double normal_deg_;
  std::vector<ProxyTriangle> triangles_;
};

}  // namespace

std::vector<float> signed_distance_to_model(device::Queue& queue, const RangeImage& image,
                                            const PlaneSegmentation& segmentation, const PolygonModel& model,
                                            const Pose& world_from_scan, double normal_deg, int tile_side) {
  if (tile_side < 1)
    fail(ErrorKind::usage, "distance_to_model: expected a tile of at least 1, found {}", tile_side);
  Distances measure(queue, model, world_from_scan, normal_deg);
  const auto triangles = queue.array(measure.triangles());
  std::vector<float> distances(image.count(), kNan), heights(image.count(), kNan);
  for (const Tile& tile : make_tiles(image.rows, image.cols, tile_side))
    measure.measure({image, segmentation, tile, nullptr}, triangles, measure.triangles().size(), 0, tile,
                    image.cols, distances, &heights);
  for (std::size_t i = 0; i < distances.size(); ++i) distances[i] = std::copysign(distances[i], heights[i]);
  return distances;
}

std::vector<float> distance_to_model(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const PolygonModel& model,
                                     const Pose& world_from_scan, double normal_deg, int tile_side) {
  auto distances =
      signed_distance_to_model(queue, image, segmentation, model, world_from_scan, normal_deg, tile_side);
  for (float& distance : distances) distance = std::abs(distance);
  return distances;
}

std::vector<float> distance_to_near_faces(device::Queue& queue, const RangeImage& image,
                                          const PlaneSegmentation& segmentation, const PolygonModel& model,
                                          const Pose& world_from_scan, double normal_deg, double gate_m,
                                          const std::vector<std::uint8_t>& wanted) {
  if (!(gate_m > 0) || wanted.size() != image.count())
    fail(ErrorKind::failed, "distance_to_near_faces: gate {}, {} flags for an image of {} samples", gate_m,
         wanted.size(), image.count());
  Distances measure(queue, model, world_from_scan, normal_deg);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const ProxyTriangle& t : measure.triangles()) boxes.push_back(box_of(t));
  std::vector<float> distances(image.count(), kNan);
  for (const Tile& tile : make_tiles(image.rows, image.cols, kGatedTile)) {
    const TileQueries queries(image, segmentation, tile, &wanted);
    if (queries.box.isEmpty()) continue;
    const auto near = triangles_near(measure.triangles(), boxes, queries, measure.local_from_scan(), gate_m);
    if (near.empty()) continue;
    measure.measure(queries, queue.array(near), near.size(), gate_m, tile, image.cols, distances);
  }
  return distances;
}

}  // namespace hybrid::stages
