#include "stages/registration/distances_to_scans.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {
namespace {

constexpr double kMostQueries = 1e6;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

SearchQueries upload(device::Queue& queue, const std::array<std::vector<float>, 6>& columns) {
  return {columns[0].size(),       queue.array(columns[0]), queue.array(columns[1]), queue.array(columns[2]),
          queue.array(columns[3]), queue.array(columns[4]), queue.array(columns[5])};
}

}  // namespace

DistancesToScans distances_to_scans(device::Queue& queue, const RangeImage& image,
                                    const PlaneSegmentation& segmentation, const Pose& world_from_scan,
                                    const std::vector<PlacedScan>& others, double reach_m,
                                    double normal_deg) {
  const auto least = std::ceil(std::sqrt(static_cast<double>(image.count()) / kMostQueries));
  const int every = std::max(static_cast<int>(least), 1);
  DistancesToScans result;
  result.image.rows = (image.rows + every - 1) / every;
  result.image.cols = (image.cols + every - 1) / every;
  result.image.mask.assign(result.image.count(), kEmpty);
  result.segmentation.sample_label.assign(result.image.count(), 0);
  result.signed_m.assign(result.image.count(), kNone);

  std::vector<std::size_t> nodes;  // of the result, measured; and where they are in the image
  std::vector<std::array<int, 2>> places;
  for (int row = 0; row < result.image.rows; ++row)
    for (int col = 0; col < result.image.cols; ++col) {
      const std::size_t node = result.image.index(row, col), i = image.index(row * every, col * every);
      result.image.mask[node] = image.mask[i];
      if (image.mask[i] != kMeasured) continue;
      result.segmentation.sample_label[node] = segmentation.sample_label[i];
      nodes.push_back(node);
      places.push_back({row * every, col * every});
    }
  if (nodes.empty() || others.empty()) return result;

  const SampleSurfaces surfaces(image, segmentation);
  std::array<std::vector<float>, 6> columns;
  for (auto& column : columns) column.resize(nodes.size());
  parallel_for(
      nodes.size(),
      [&](std::size_t k) {
        const auto [row, col] = places[k];
        const Vec3 point = image.point(image.index(row, col)), normal = surfaces.at(row, col).normal;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          columns[axis][k] = static_cast<float>(point(static_cast<Eigen::Index>(axis)));
          columns[3 + axis][k] = static_cast<float>(normal(static_cast<Eigen::Index>(axis)));
        }
      },
      1 << 12);
  const SearchQueries queries = upload(queue, columns);
  SampleAnswers answers(queue, nodes.size());
  std::vector<float> nearest(nodes.size(), std::numeric_limits<float>::infinity());
  for (const PlacedScan& other : others) {
    if (!other.scan->surface->known()) continue;
    const Pose& there = other.world_from_scan;
    other.scan->surface->find(queries, there.inverse() * world_from_scan, reach_m / there.scale, normal_deg,
                              answers);
    const auto distances = queue.read(answers.distance), heights = queue.read(answers.height);
    const auto scale = static_cast<float>(there.scale);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!(scale * distances[k] < nearest[k])) continue;  // NaN: none
      nearest[k] = scale * distances[k];
      result.signed_m[nodes[k]] = scale * heights[k];
    }
  }
  return result;
}

}  // namespace hybrid::stages
