#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.hpp"

namespace hybrid {

// A scan as its file gave it: samples in file order, in the scan frame (origin at the mirror). Sample i is
// what `source` indices refer to. Non-finite points and points at the origin are no-returns.
struct Scan {
  std::string name;
  std::vector<std::array<float, 3>> points;  // metres, relative to `origin`
  Vec3 origin = Vec3::Zero();    // added to every point: keeps georeferenced input precise in float
  std::vector<float> intensity;  // one per point, or empty
  std::vector<std::array<std::uint8_t, 3>> rgb;  // one per point, or empty
  int grid_rows = 0, grid_cols = 0;  // organised input: rows by ascending elevation as scanned, or
                                     // descending: not yet ordered
  bool row_by_row = false;           // order of an organised file's samples; else column by column
  // Node (row * grid_cols + col) of each sample of an organised file whose samples are not one per node in
  // that order: some are missing, in any order, or several returns of one node, of which the first takes it.
  // kNoNode: none, as of further returns. Empty otherwise.
  std::vector<std::uint32_t> node;
  static constexpr std::uint32_t kNoNode = 0xffffffffu;
  Vec3 point(std::size_t i) const { return origin + Vec3(points[i][0], points[i][1], points[i][2]); }
  bool organised() const { return grid_rows > 1 && grid_cols > 1; }
  // Of a sample in a grid without `node`.
  std::size_t grid_index(int row, int col) const {
    const int slow = row_by_row ? row : col, fast = row_by_row ? col : row;
    return static_cast<std::size_t>(slow) * static_cast<std::size_t>(row_by_row ? grid_cols : grid_rows) +
           static_cast<std::size_t>(fast);
  }
  std::optional<Pose> world_from_scan;  // as recorded in the file, if it was
  std::vector<std::string> notes;       // oddities worth telling the user (dropped fields, ...)
};

}  // namespace hybrid
