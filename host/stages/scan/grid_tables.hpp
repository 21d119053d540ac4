#pragma once
#include <optional>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid::stages {

// The returns of an organised scan by the rows and columns of its file.
class NodePoints {
 public:
  NodePoints(int rows, int cols) : rows_(rows), cols_(cols) {}
  virtual ~NodePoints() = default;
  int rows() const { return rows_; }
  int cols() const { return cols_; }
  // False: no return there.
  virtual bool find(int row, int col, Vec3& point) const = 0;

 private:
  int rows_, cols_;
};

// The angles of a range image's rows and columns, top row and least azimuth first, and what must be turned in
// the file's grid for that.
struct GridTables {
  std::vector<double> elevation_rad, azimuth_rad;
  bool even = false, flip_rows = false, flip_cols = false;
};

// Medians of the measured samples; rows and columns without any continue their neighbours. Nothing where the
// grid is not spherical about Z.
std::optional<GridTables> angle_tables(const NodePoints& nodes);

// For such a grid as it stays (`even`): the typical angles between neighbours, around 0.
GridTables even_tables(const NodePoints& nodes);

// NaN entries by linear interpolation, beyond the ends with the mean step; noise about an even table is
// evened out. Returns whether they go one way, as nearly all must: -1 down, 1 up, 0 neither.
int complete_table(std::vector<double>& table);

}  // namespace hybrid::stages
