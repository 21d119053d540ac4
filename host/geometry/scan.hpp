#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.hpp"

namespace hybrid {

// A record of a LAS file that says what its coordinates refer to (user id LASF_Projection), carried as it is.
struct CrsRecord {
  std::uint16_t id = 0;
  std::string bytes;
};

// The steps in which a file gives coordinates: whole number * scale + offset.
struct CoordinateSteps {
  Vec3 scale = Vec3::Zero(), offset = Vec3::Zero();
};

// What a range image says of its grid beyond the samples: a scan read from one is laid out as that image was.
struct RangeGrid {
  std::vector<double> elevation_rad;  // per row, decreasing
  std::vector<double> azimuth_rad;    // per column, increasing
  bool wraps = false;                 // the last column neighbours the first one
  // Nodes that were interpolated between samples, ascending, with x y z and range: they help planes and are
  // no samples.
  std::vector<std::uint32_t> interpolated;
  std::vector<std::array<float, 4>> interpolated_point;
};

// A scan as its file gave it: samples in file order, in the scan frame (origin at the mirror). Sample i is
// what `source` indices refer to. Non-finite points and points at the origin are no-returns.
struct Scan {
  std::string name;
  std::vector<std::array<float, 3>> points;  // metres, relative to `origin`
  Vec3 origin = Vec3::Zero();  // added to every point: keeps georeferenced input precise in float
  // For conversions alone (io::ReadOptions::exact): the coordinates as the file has them, absolute, one per
  // point; what is no return is so by `points`. Empty where `points` hold the same.
  std::vector<std::array<double, 3>> exact;
  std::optional<CoordinateSteps> steps;          // of `exact`, where the file stores whole numbers
  std::vector<float> intensity;                  // one per point, or empty
  std::vector<std::array<std::uint8_t, 3>> rgb;  // one per point, or empty
  int grid_rows = 0, grid_cols = 0;  // organised input: rows by ascending elevation as scanned, or
                                     // descending: not yet ordered
  bool row_by_row = false;           // order of an organised file's samples; else column by column
  // Of a range image: row by row; samples from grid_rows * grid_cols on lie beside the grid.
  std::optional<RangeGrid> range_grid;
  // Node (row * grid_cols + col) of each sample of an organised file whose samples are not one per node in
  // that order: some are missing, in any order, or several returns of one node, of which the first takes it.
  // kNoNode: none, as of further returns. Empty otherwise.
  std::vector<std::uint32_t> node;
  static constexpr std::uint32_t kNoNode = 0xffffffffu;
  Vec3 point(std::size_t i) const { return origin + Vec3(points[i][0], points[i][1], points[i][2]); }
  Vec3 exact_point(std::size_t i) const {
    return exact.empty() ? point(i) : Vec3(exact[i][0], exact[i][1], exact[i][2]);
  }
  bool organised() const { return grid_rows > 1 && grid_cols > 1; }
  // Of a sample in a grid without `node`.
  std::size_t grid_index(int row, int col) const {
    const int slow = row_by_row ? row : col, fast = row_by_row ? col : row;
    return static_cast<std::size_t>(slow) * static_cast<std::size_t>(row_by_row ? grid_cols : grid_rows) +
           static_cast<std::size_t>(fast);
  }
  bool scanner_is_known = false;        // somebody said where it stood: the origin is no guess
  std::optional<Pose> world_from_scan;  // as recorded in the file, if it was
  // Least and greatest value that `intensity` can have, where the format says.
  std::optional<std::array<float, 2>> intensity_limits;
  // What georeferenced coordinates refer to, WKT or "EPSG:27700", else "": carried, never interpreted.
  std::string crs;
  std::vector<CrsRecord> crs_records;  // the same as a LAS file holds it
  std::vector<std::string> notes;      // oddities worth telling the user (dropped fields, ...)
};

}  // namespace hybrid
