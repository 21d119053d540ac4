#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "device/queue.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "shared/params_closest_sample.h"
#include "stages/registration/proxy_search.hpp"

namespace hybrid::stages {

// The edges between rows, descending, and columns, ascending, by what kernels/lib/range_grid.h measures; one
// more than there are rows or columns. Of angles, radians, or of a pinhole's measures themselves.
std::vector<float> row_edges(const std::vector<double>& rows, std::uint32_t lens);
std::vector<float> col_edges(const std::vector<double>& cols, std::uint32_t lens);

SamplePlace sample_place(const Pose& grid_from_queries);

// The bins of such edges as kernels/lib/range_grid.h looks them up; `sign`: -1 of rows, 1 of columns.
struct EdgeBins {
  float per_unit = 0;
  std::vector<std::uint32_t> starts;  // [GRID_BINS + 1]
};
EdgeBins edge_bins(const std::vector<float>& edges, float sign);

// The least and the largest range of blocks of nodes as closest_sample.cl takes them. `ranges` [rows * cols]
// metres, NaN = none.
std::vector<float> block_ranges(const std::vector<float>& ranges, int rows, int cols);

// What closest_sample.cl answers, on the device; of several places of one after the other.
struct SampleAnswers {
  device::Array<float> distance, height, normal_x, normal_y, normal_z, clearance;
  SampleAnswers(device::Queue& queue, std::size_t queries, std::size_t places = 1);
};

// A scan as others are laid on it: the samples of its grid with the normals of the surfaces they lie on. Of
// samples of superclusters it holds their feet on the plane and its normal, of others the plane through the
// neighbours, depth jumps left out; strays are none. Of a scan of more than a million nodes every n-th row
// and column, their normals from all. An image whose rows and columns are no angles is taken for a pinhole's
// where it is one.
class ScanSurface {
 public:
  // `stray` per node, or empty.
  ScanSurface(device::Queue& queue, const RangeImage& image, const PlaneSegmentation& segmentation,
              const std::vector<std::uint8_t>& stray);

  // False: the grid's directions are unknown, and nothing can be found in it.
  bool known() const { return known_; }
  // How far samples lie apart, per metre of range.
  double spacing() const { return spacing_; }
  // The axes that normals of answers are in: the scan's, or with x along the pinhole's axis.
  const Pose& grid_from_scan() const { return grid_from_scan_; }

  // Per query the closest compatible sample; kernel closest_sample. `scan_from_queries`: one place or
  // several, of one scale and CLOSEST_SAMPLE_PLACES at most. `normal_deg`: the largest angle between normals.
  // Needs known().
  void find(const SearchQueries& queries, std::span<const Pose> scan_from_queries, double gate_m,
            double normal_deg, SampleAnswers& answers) const;
  void find(const SearchQueries& queries, const Pose& scan_from_queries, double gate_m, double normal_deg,
            SampleAnswers& answers) const {
    find(queries, std::span(&scan_from_queries, 1), gate_m, normal_deg, answers);
  }

 private:
  device::Queue& queue_;
  bool known_ = false;
  double spacing_ = 0;
  Pose grid_from_scan_;
  ClosestSampleParams params_{};
  device::Array<float> ranges_, points_, normals_, block_ranges_, row_edges_, col_edges_;
  device::Array<std::uint32_t> row_starts_, col_starts_;
};

}  // namespace hybrid::stages
