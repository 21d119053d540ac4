#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "lib/random.h"
#include "stages/registration/icp.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {
namespace {

// Grazing samples would stand for areas they hardly know: at most 20 times the area seen head on.
constexpr double kMinCosine = 0.05;

// Nodes of a row that are looked at together.
constexpr int kChunk = 64;
using Chunk = Eigen::Array<double, kChunk, 1>;

// Half the way to both neighbours; the image's other step where there is only one row or column.
double step_at(const std::vector<double>& angles, int i, double fallback) {
  const int last = static_cast<int>(angles.size()) - 1;
  if (last < 1) return fallback > 0 ? fallback : 1;
  const int low = std::max(i - 1, 0), high = std::min(i + 1, last);
  return std::abs(angles[static_cast<std::size_t>(high)] - angles[static_cast<std::size_t>(low)]) /
         (high - low);
}

struct Areas {
  // `no_plane`: of the measured samples outside superclusters that are no strays, as if seen head on; else of
  // the superclusters'.
  Areas(const RangeImage& range_image, const PlaneSegmentation& planes,
        const std::vector<std::uint8_t>* no_plane = nullptr)
      : image(range_image),
        segmentation(planes),
        stray(no_plane),
        of_row(image.elevation_rad),
        of_col(image.azimuth_rad) {
    if (segmentation.sample_label.size() != image.count())
      fail(ErrorKind::failed, "samples by area: {} labels for {} nodes", segmentation.sample_label.size(),
           image.count());
    for (int row = 0; row < image.rows; ++row)
      of_row[static_cast<std::size_t>(row)] = std::cos(image.elevation_rad[static_cast<std::size_t>(row)]) *
                                              step_at(image.elevation_rad, row, image.azimuth_step_rad());
    for (int col = 0; col < image.cols; ++col)
      of_col[static_cast<std::size_t>(col)] = step_at(image.azimuth_rad, col, image.elevation_step_rad());
  }

  const RangeImage& image;
  const PlaneSegmentation& segmentation;
  const std::vector<std::uint8_t>* stray;
  std::vector<double> of_row, of_col;  // their product: the node's solid angle

  // Area in m2 that each of the nodes from `col` on stands for, as many as are in the row; 0 for nodes that
  // are no such samples.
  Chunk of_chunk(int row, int col) const {
    Chunk x = Chunk::Zero(), y = x, z = x, along = x, angle = x;
    const int count = std::min(kChunk, image.cols - col);
    for (int k = 0; k < count; ++k) {
      const std::size_t i = image.index(row, col + k);
      const std::uint32_t label = segmentation.sample_label[i];
      if (image.mask[i] != kMeasured || (stray == nullptr) != (label > 0)) continue;
      if (label == 0 && !stray->empty() && (*stray)[i] != 0) continue;
      const Vec3 p = image.point(i);
      x[k] = p.x(), y[k] = p.y(), z[k] = p.z();
      along[k] = label > 0 ? segmentation.superclusters[label - 1].plane.normal.dot(p) : p.norm();
      angle[k] = of_col[static_cast<std::size_t>(col + k)];
    }
    const Chunk range = (x * x + (y * y + z * z)).sqrt();
    const Chunk area =
        range * range * of_row[static_cast<std::size_t>(row)] * angle / (along.abs() / range).max(kMinCosine);
    return (range > 0).select(area, 0.0);
  }
};

struct Chosen {
  std::size_t node;
  double area;
};

// Draws of one row, the areas of whose chunks are known and whose share of the area begins at `before`: draw
// k lies in [k, k + 1) shares.
std::vector<Chosen> draw_row(const Areas& areas, int row, std::span<const double> chunk_area, double before,
                             double share, std::uint32_t seed) {
  std::vector<Chosen> chosen;
  auto next = static_cast<std::uint64_t>(std::max(std::floor(before / share) - 1, 0.0));
  const auto place = [&](std::uint64_t k) {
    return (static_cast<double>(k) + random_bits(seed, static_cast<std::uint32_t>(k), 0) / 4294967296.0) *
           share;
  };
  while (place(next) < before) ++next;
  double next_place = place(next);
  for (int col = 0; col < areas.image.cols; col += kChunk) {
    double end = before;
    before += chunk_area[static_cast<std::size_t>(col / kChunk)];
    if (next_place >= before) continue;  // as in most
    const Chunk area = areas.of_chunk(row, col);
    for (int k = 0; k < kChunk; ++k) {
      if (area[k] == 0) continue;
      end += area[k];
      int draws = 0;
      for (; next_place < end; next_place = place(++next)) ++draws;
      if (draws > 0) chosen.push_back({areas.image.index(row, col + k), draws * share});
    }
  }
  return chosen;
}

std::vector<Chosen> all_of_row(const Areas& areas, int row) {
  std::vector<Chosen> chosen;
  for (int col = 0; col < areas.image.cols; col += kChunk) {
    const Chunk area = areas.of_chunk(row, col);
    for (int k = 0; k < kChunk; ++k)
      if (area[k] > 0) chosen.push_back({areas.image.index(row, col + k), area[k]});
  }
  return chosen;
}

// Row by row.
std::vector<Chosen> choose(const Areas& areas, int max_samples, int seed) {
  const RangeImage& image = areas.image;
  const auto rows = static_cast<std::size_t>(image.rows),
             chunks = static_cast<std::size_t>((image.cols + kChunk - 1) / kChunk);
  std::vector<double> row_area(rows), before(rows), chunk_area(rows * chunks);
  std::vector<std::size_t> row_count(rows);
  parallel_for(rows, [&](std::size_t row) {
    for (std::size_t c = 0; c < chunks; ++c) {
      const Chunk area = areas.of_chunk(static_cast<int>(row), static_cast<int>(c) * kChunk);
      double sum = 0;
      for (int k = 0; k < kChunk; ++k) sum += area[k];
      chunk_area[row * chunks + c] = sum;
      row_area[row] += sum;
      row_count[row] += static_cast<std::size_t>((area > 0).count());
    }
  });
  std::exclusive_scan(row_area.begin(), row_area.end(), before.begin(), 0.0);
  const std::size_t count = std::accumulate(row_count.begin(), row_count.end(), std::size_t{0});
  const double total = rows ? before.back() + row_area.back() : 0;

  const bool all = max_samples <= 0 || count <= static_cast<std::size_t>(max_samples);
  std::vector<std::vector<Chosen>> by_row(rows);
  parallel_for(rows, [&](std::size_t row) {
    if (row_count[row] == 0) return;
    by_row[row] =
        all ? all_of_row(areas, static_cast<int>(row))
            : draw_row(areas, static_cast<int>(row), std::span(chunk_area).subspan(row * chunks, chunks),
                       before[row], total / max_samples, static_cast<std::uint32_t>(seed));
  });
  std::vector<Chosen> chosen;
  for (const auto& row : by_row) chosen.insert(chosen.end(), row.begin(), row.end());
  return chosen;
}

}  // namespace

PlanarSamples choose_planar_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                    int max_samples, int seed) {
  auto chosen = choose(Areas(image, segmentation), max_samples, seed);
  // One supercluster after the other: neighbouring lanes of closest_point then pass over the same faces.
  std::stable_sort(chosen.begin(), chosen.end(), [&](const Chosen& a, const Chosen& b) {
    return segmentation.sample_label[a.node] < segmentation.sample_label[b.node];
  });

  PlanarSamples samples;
  for (const Chosen& one : chosen) {
    const std::uint32_t supercluster = segmentation.sample_label[one.node] - 1;
    const Plane& plane = segmentation.superclusters[supercluster].plane;
    const Vec3 p = image.point(one.node), on_plane = p - plane.distance(p) * plane.normal;
    const Vec3f point = on_plane.cast<float>(), normal = plane.normal.cast<float>();
    samples.points.push_back({point.x(), point.y(), point.z(), static_cast<float>(one.area)});
    samples.normals.push_back({normal.x(), normal.y(), normal.z(), 0});
    samples.supercluster.push_back(supercluster);
  }
  return samples;
}

PlanarSamples choose_free_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                  const std::vector<std::uint8_t>& stray, int max_samples, int seed) {
  const auto chosen = choose(Areas(image, segmentation, &stray), max_samples, seed);
  const SampleSurfaces surfaces(image, segmentation);
  std::vector<Vec3f> normals(chosen.size());
  parallel_for(chosen.size(), [&](std::size_t k) {
    const auto node = static_cast<int>(chosen[k].node);
    normals[k] = surfaces.at(node / image.cols, node % image.cols).normal.cast<float>();
  });
  PlanarSamples samples;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (normals[k].isZero()) continue;
    const Vec3f point = image.point(chosen[k].node).cast<float>();
    samples.points.push_back({point.x(), point.y(), point.z(), static_cast<float>(chosen[k].area)});
    samples.normals.push_back({normals[k].x(), normals[k].y(), normals[k].z(), 0});
  }
  return samples;
}

}  // namespace hybrid::stages
