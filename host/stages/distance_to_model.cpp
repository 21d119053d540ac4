#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "geometry/tiles.hpp"
#include "stages/icp.hpp"
#include "stages/proxy_search.hpp"

namespace hybrid::stages {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

constexpr int kGatedTile = 128;  // small: wanted nodes are few

// Queries of one tile, dense; a node that was not measured, or is not wanted, gets a NaN position.
struct TileQueries {
  std::vector<float> values[6];  // x y z nx ny nz
  bool any = false;              // has a position

  TileQueries(const RangeImage& image, const PlaneSegmentation& segmentation, const Tile& tile,
              const std::vector<std::uint8_t>* wanted) {
    const auto count = static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.cols);
    for (auto& column : values) column.assign(count, kNan);
    std::size_t k = 0;
    for (int row = tile.row; row < tile.row + tile.rows; ++row)
      for (int col = tile.col; col < tile.col + tile.cols; ++col, ++k) {
        const std::size_t i = image.index(row, col);
        if (image.mask[i] != kMeasured || (wanted != nullptr && (*wanted)[i] == 0)) continue;
        any = true;
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

class Distances {
 public:
  // World axes, origin at the scanner: all samples lie around it.
  Distances(device::Queue& queue, const ProxyModel& model, const Pose& world_from_scan, double normal_deg,
            double gate_m)
      : queue_(queue),
        local_from_scan_(world_from_scan),
        normal_deg_(normal_deg),
        gate_m_(gate_m),
        search_(queue, model, world_from_scan.translation) {
    local_from_scan_.translation.setZero();
  }

  // Of one tile, into the image's nodes.
  void measure(const TileQueries& queries, const Tile& tile, int image_cols, std::vector<float>& distances,
               std::vector<float>* heights = nullptr) {
    const auto& v = queries.values;
    const SearchQueries on_device{v[0].size(),        queue_.array(v[0]), queue_.array(v[1]),
                                  queue_.array(v[2]), queue_.array(v[3]), queue_.array(v[4]),
                                  queue_.array(v[5])};
    SearchAnswers answers(queue_, on_device.count);
    search_.find(on_device, local_from_scan_, gate_m_, normal_deg_, answers);
    const auto read = [&](const device::Array<float>& from, std::vector<float>& to) {
      queue_.read_rect(from, to.data(), static_cast<std::size_t>(image_cols),
                       {static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                        static_cast<std::size_t>(tile.rows), static_cast<std::size_t>(tile.cols)});
    };
    read(answers.distance, distances);
    if (heights != nullptr) read(answers.height, *heights);
  }

 private:
  device::Queue& queue_;
  Pose local_from_scan_;
  double normal_deg_, gate_m_;
  ProxySearch search_;
};

}  // namespace

std::vector<float> signed_distance_to_model(device::Queue& queue, const RangeImage& image,
                                            const PlaneSegmentation& segmentation, const ProxyModel& model,
                                            const Pose& world_from_scan, double normal_deg, int tile_side) {
  if (tile_side < 1)
    fail(ErrorKind::usage, "distance_to_model: expected a tile of at least 1, found {}", tile_side);
  Distances measure(queue, model, world_from_scan, normal_deg, 0);
  std::vector<float> distances(image.count(), kNan), heights(image.count(), kNan);
  for (const Tile& tile : make_tiles(image.rows, image.cols, tile_side))
    measure.measure({image, segmentation, tile, nullptr}, tile, image.cols, distances, &heights);
  for (std::size_t i = 0; i < distances.size(); ++i) distances[i] = std::copysign(distances[i], heights[i]);
  return distances;
}

std::vector<float> distance_to_model(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const ProxyModel& model,
                                     const Pose& world_from_scan, double normal_deg, int tile_side) {
  auto distances =
      signed_distance_to_model(queue, image, segmentation, model, world_from_scan, normal_deg, tile_side);
  for (float& distance : distances) distance = std::abs(distance);
  return distances;
}

std::vector<float> distance_to_near_faces(device::Queue& queue, const RangeImage& image,
                                          const PlaneSegmentation& segmentation, const ProxyModel& model,
                                          const Pose& world_from_scan, double normal_deg, double gate_m,
                                          const std::vector<std::uint8_t>& wanted) {
  if (!(gate_m > 0) || wanted.size() != image.count())
    fail(ErrorKind::failed, "distance_to_near_faces: gate {}, {} flags for an image of {} samples", gate_m,
         wanted.size(), image.count());
  Distances measure(queue, model, world_from_scan, normal_deg, gate_m);
  std::vector<float> distances(image.count(), kNan);
  for (const Tile& tile : make_tiles(image.rows, image.cols, kGatedTile)) {
    const TileQueries queries(image, segmentation, tile, &wanted);
    if (queries.any) measure.measure(queries, tile, image.cols, distances);
  }
  return distances;
}

}  // namespace hybrid::stages
