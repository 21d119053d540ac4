#pragma once
#include <array>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid::stages {

// How far samples bend away from their best plane: least squares of a quadratic height field over the plane.
struct Bend {
  double share = 0;         // of the squared residuals explained by it; 0 when it is not significant
  double curvature = 0;     // 1/m, the larger principal one
  double sigma = 0;         // of the curvature across the samples' narrower extent, 1/m
  bool determined = false;  // samples enough to tell, not in one line or two
};

// The share below which a bend is taken for a rim's, or the instrument's.
inline constexpr double kLeastShareBent = 0.01;

// `heights`: (a, b, height) in m, a and b along the plane. A bend of min_curvature (1/m) or less has share 0.
Bend bend_of(const std::vector<Vec3>& heights, double min_curvature);

// By how many variances of their residuals the bend of a larger surface that `beyond` shows, which holds or
// surrounds `heights` and has the same axes, explains these better than no bend does: both with the offset
// and tilt that suit them best. Negative where they are flatter than that; about 0 where they are too few or
// too small to tell. 0 when the samples of either are fewer than 30 or in a line.
double bends_like(const std::vector<Vec3>& heights, const std::vector<Vec3>& beyond);

// Heights of a plane's samples over it, as (a, b, height). At its rim a plane may hold the first samples
// beyond an edge, which would bend a narrow strip.
struct PlaneHeights {
  std::vector<Vec3> all;
  std::vector<Vec3> inner;                   // whose four neighbours on the grid are the plane's too
  std::array<std::vector<Vec3>, 4> trimmed;  // that have a neighbour of the plane's on that side
  // Of a dense scan, that lie deeper than the first samples beyond an edge can; may be left empty.
  std::vector<Vec3> core;

  // `neighbours`: the plane holds the node to the right, below, left, above.
  void add(const Vec3& height, const std::array<bool, 4>& neighbours);
  // The bend of all; its share is the least of those of all, of what is left without the outermost samples of
  // one side, and without those of all sides, as far as they can show a bend. The core's counts, too, unless
  // it is too small to be significant and yet as sharp: then the whole bends, and not its rim alone.
  Bend bend(double min_curvature) const;
};

}  // namespace hybrid::stages
