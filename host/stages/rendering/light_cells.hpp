#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "geometry/image.hpp"
#include "geometry/vectors.hpp"

namespace hybrid::stages {

using LogLight = std::array<float, 3>;  // logarithm of linear light; NaN: no use

// The mean light of a photograph in squares about any places, well exposed ones: bytes outside [8, 247] are
// clipped or noise. Large squares are summed from cells of 1/16 of their side, so that a photograph's pixels
// are looked at once, however many places are asked for.
class LightCells {
 public:
  // sRGB, with a mask as fourth channel or without; `reach_px` is half a square's side.
  LightCells(const Image8& image, double reach_px);

  int step_px() const { return step_; }
  // About a place in pixels (centres at half numbers); NaN where a pixel of a cell is masked or not well
  // exposed.
  LogLight around(const Vec2& position) const;

 private:
  int step_, cols_, rows_, width_, height_;
  double reach_;
  std::vector<std::array<float, 3>> mean_;  // linear light per cell, row by row; NaN: no use
};

}  // namespace hybrid::stages
