#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/e57/scan_columns.hpp"

namespace hybrid::io {

// A grid this much larger than its samples is a crop of a scan, or none: stages hold whole images.
inline constexpr std::uint64_t kMostNodesPerSample = 16, kFreeNodes = 1 << 16;

// rows * columns, or 0: more nodes than can be numbered.
std::uint64_t grid_nodes(std::uint64_t rows, std::uint64_t columns);
// What is said of indices that make no grid, or "": where it has far more nodes than samples.
inline constexpr const char* kNoGrid = "row and column indices are not of a grid: taken as not organised";
std::string too_sparse(std::uint64_t rows, std::uint64_t columns, std::uint64_t samples);

// Makes a scan's grid from its samples' row and column indices, which come in any order and need not be
// complete: the smallest rectangle that holds them. A sample's node is known only when all indices are, so
// they are kept relative to what the file declares, until then.
class ScanGrid {
 public:
  ScanGrid(const E57Scan& scan, const ScanColumns& columns, std::uint64_t count);

  // Takes a range of records; several at once for disjoint ranges.
  void add(const E57Records& records);
  // Whether some indices lie outside what the file declares: then call restart() and add() all again.
  bool outside() const;
  void restart();

  // Sets the scan's grid and, unless its samples are in the grid's order, their nodes; a note when the
  // indices make no grid. Of several returns the first valid one takes the node.
  void finish(Scan& scan);

  // By which the first of several returns is told: beyond 255 all are alike.
  static std::uint8_t kept_return(double index) {
    return static_cast<std::uint8_t>(index > 0 ? std::min(index, 255.0) : 0.0);
  }

  struct Bounds {
    std::int64_t low = 0, high = -1;
    std::uint64_t extent() const {
      return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
    }
  };
  // Of an index, as the file has it: indexBounds, else the field's own limits.
  static Bounds declared(const std::optional<E57Limits>& bounds, const E57Field& field);

 private:
  struct Range {
    Bounds row, column;
    bool outside = false, several = false;
  };
  bool choose_frame(Bounds row, Bounds column);
  bool in_order(const Scan& scan, bool row_by_row) const;
  void keep_first_returns(const Scan& scan, std::uint64_t nodes);

  const ScanColumns& columns_;
  bool usable_ = false;
  Bounds row_, column_;  // of the frame that `node_` counts in
  std::vector<std::uint32_t> node_;
  std::vector<std::uint8_t> return_;
  std::vector<Range> ranges_;
};

}  // namespace hybrid::io
