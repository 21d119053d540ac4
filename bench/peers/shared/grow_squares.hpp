#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "shared/range_exr.hpp"

namespace hybrid::peers {

// What a per-square fit found.
struct SquareFit {
  bool planar = false;
  Eigen::Vector3f normal, centroid;  // unit length, towards the scanner
};

// Extent in squares, partial ones at the right and bottom included.
struct SquareExtent {
  int side, rows, cols;
  SquareExtent(const RangeScan& scan, int square)
      : side(square), rows((scan.rows + square - 1) / square), cols((scan.cols + square - 1) / square) {}
  std::size_t count() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
};

// Nodes of one square that hold a point.
void square_nodes(const RangeScan&, const SquareExtent&, int row, int col, std::vector<std::uint32_t>& nodes);

// Planes out of squares as any engineer would grow them: neighbouring squares join when their normals differ
// by less than 5 degrees and each one's centroid lies within 4 sigma + 5 mm of the other's plane; groups of 8
// squares or more become planes (average normal and centroid), and the points of their squares and of the
// squares around them within 3 sigma + 2 mm get the label.
std::vector<std::uint32_t> grow_squares(const RangeScan&, const SquareExtent&, const std::vector<SquareFit>&,
                                        double sigma_m);

}  // namespace hybrid::peers
