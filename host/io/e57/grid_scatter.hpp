#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/e57/scan_grid.hpp"
#include "io/e57/scan_samples.hpp"
#include "io/grid_scan.hpp"

namespace hybrid::io {

// Puts the samples of records into the nodes of a range image as they come: strips of 65,536 are gathered and
// sorted by row, as scanners go column by column and each sample alone would take seven lines of a cache from
// memory.
class GridScatter {
 public:
  GridScatter(GridScatter&&) noexcept;
  ~GridScatter();
  // Nothing where what the file declares of the indices makes no grid that is worth its memory. Decodes the
  // first records, to tell which way rows and columns go.
  static std::optional<GridScatter> of(const E57Scan& scan, const ScanSamples& samples,
                                       const E57RecordReader& reader);

  // A range of records with its points; several at once for disjoint ranges.
  void add(const E57Records& records, std::span<const std::array<float, 3>> points,
           std::span<const float> intensity, std::span<const std::array<std::uint8_t, 3>> rgb);

  // The image, cut to the smallest rectangle that holds all indices; nothing where some lie outside what the
  // file declares, two returns share a node, or that rectangle is none. To be called once.
  std::optional<GridScan> finish();

 private:
  struct Range {
    ScanGrid::Bounds row, column;
    bool outside = false;
    std::uint64_t finite = 0, returns = 0;
  };
  GridScatter(const ScanColumns& columns, ScanGrid::Bounds row, ScanGrid::Bounds column, std::uint64_t count);
  void guess_directions(const ScanSamples& samples, const E57RecordReader& reader);
  struct Strip;
  struct Strips;
  void put_strip(Strip& strip);
  void crop(ScanGrid::Bounds row, ScanGrid::Bounds column);

  const ScanColumns* columns_;
  ScanGrid::Bounds row_, column_;  // as declared
  GridScan grid_;
  std::vector<Range> ranges_;
  std::unique_ptr<Strips> strips_;
};

}  // namespace hybrid::io
