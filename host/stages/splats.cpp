#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/render.hpp"
#include "stages/sample_surface.hpp"

namespace hybrid::stages {
namespace {

std::vector<Splat> row_splats(const RangeImage& image, const PlaneSegmentation& segmentation,
                              const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan,
                              std::uint32_t scan_index, int row) {
  std::vector<Splat> splats;
  for (int col = 0; col < image.cols; ++col) {
    const std::size_t i = image.index(row, col);
    if (drawn[i] == kNotDrawn || image.mask[i] != kMeasured) continue;
    const SampleSurface surface = sample_surface(image, segmentation, row, col);
    const Vec3f centre = (world_from_scan * image.point(i)).cast<float>();
    const Vec3f normal = world_from_scan.rotate(surface.normal).cast<float>();
    splats.push_back({{centre.x(), centre.y(), centre.z()},
                      static_cast<float>(surface.radius_m * world_from_scan.scale),
                      {normal.x(), normal.y(), normal.z()},
                      scan_index,
                      drawn[i] == kDrawnOffFaces});
  }
  return splats;
}

}  // namespace

std::vector<Splat> make_splats(const RangeImage& image, const PlaneSegmentation& segmentation,
                               const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan,
                               std::uint32_t scan_index) {
  if (drawn.size() != image.count())
    fail(ErrorKind::failed, "make_splats: expected a flag for each of {} nodes, found {}", image.count(),
         drawn.size());
  std::vector<std::vector<Splat>> rows(static_cast<std::size_t>(image.rows));
  parallel_for(rows.size(), [&](std::size_t row) {
    rows[row] = row_splats(image, segmentation, drawn, world_from_scan, scan_index, static_cast<int>(row));
  });
  std::vector<Splat> splats;
  for (const auto& row : rows) splats.insert(splats.end(), row.begin(), row.end());
  return splats;
}

}  // namespace hybrid::stages
