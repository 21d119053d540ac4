#include <algorithm>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/rendering/render.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {
namespace {

std::vector<Splat> row_splats(const RangeImage& image, const SampleSurfaces& surfaces,
                              const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan,
                              std::uint32_t scan_index, int every, int row) {
  std::vector<Splat> splats;
  for (int col = 0; col < image.cols; col += every) {
    const std::size_t i = image.index(row, col);
    if (drawn[i] == kNotDrawn || image.mask[i] != kMeasured) continue;
    const SampleSurface surface = surfaces.at(row, col);
    const Vec3f centre = (world_from_scan * image.point(i)).cast<float>();
    const Vec3f normal = world_from_scan.rotate(surface.normal).cast<float>();
    splats.push_back({{centre.x(), centre.y(), centre.z()},
                      static_cast<float>(surface.radius_m * every * world_from_scan.scale),
                      {normal.x(), normal.y(), normal.z()},
                      scan_index,
                      drawn[i] == kDrawnOffFaces});
  }
  return splats;
}

}  // namespace

std::vector<Splat> make_splats(const RangeImage& image, const PlaneSegmentation& segmentation,
                               const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan,
                               std::uint32_t scan_index, int every) {
  if (drawn.size() != image.count())
    fail(ErrorKind::failed, "make_splats: expected a flag for each of {} nodes, found {}", image.count(),
         drawn.size());
  const SampleSurfaces surfaces(image, segmentation);
  std::vector<std::vector<Splat>> rows(static_cast<std::size_t>((image.rows + every - 1) / every));
  parallel_for(rows.size(), [&](std::size_t row) {
    rows[row] =
        row_splats(image, surfaces, drawn, world_from_scan, scan_index, every, every * static_cast<int>(row));
  });
  std::vector<std::size_t> begin(rows.size() + 1, 0);
  for (std::size_t row = 0; row < rows.size(); ++row) begin[row + 1] = begin[row] + rows[row].size();
  std::vector<Splat> splats(begin.back());
  parallel_for(rows.size(), [&](std::size_t row) {
    std::copy(rows[row].begin(), rows[row].end(), splats.begin() + static_cast<std::ptrdiff_t>(begin[row]));
    rows[row] = {};
  });
  return splats;
}

}  // namespace hybrid::stages
