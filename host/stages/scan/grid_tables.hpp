#pragma once
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
// the file's grid for that. Medians of the measured samples; rows and columns without any continue their
// neighbours. `even`: the grid is not spherical about Z and stays as it is; typical angles around 0.
struct GridTables {
  std::vector<double> elevation_rad, azimuth_rad;
  bool even = false, flip_rows = false, flip_cols = false;
};
GridTables find_grid_tables(const NodePoints& nodes);

}  // namespace hybrid::stages
