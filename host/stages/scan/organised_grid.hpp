#pragma once
#include "geometry/range_image.hpp"
#include "geometry/scan.hpp"
#include "stages/scan/grid_layout.hpp"

namespace hybrid::stages {

// The input's own grid as it is (METHOD 1: organised inputs skip resampling), only turned so that row 0 is
// the highest and columns go with increasing azimuth, and laid out anew where the file's rows and columns are
// not elevations and azimuths (GridLayout; `layout` tells). Every return becomes a measured node; nothing is
// interpolated. Samples may be sparse and in any order (Scan::node): of several at a node the first return
// takes it, the others are RangeImage::extra. The angle tables are medians of the measured samples; rows and
// columns without any continue their neighbours. A grid that is not spherical about Z however it is laid out
// (a camera's depth image) stays as it is, with even tables of the typical angles between neighbours around
// 0, so that steps mean what they say. Throws ErrorKind::input when the grid does not match the sample count
// or holds no return. With Scan::range_grid, everything about the grid is taken from there.
RangeImage arrange_grid(const Scan& scan, GridLayout* layout = nullptr);

// The same of a range image that holds the file's grid already, its first row (or column) the file's last
// where it says reversed: fills the tables, and turns what is not turned yet.
GridLayout orient_grid(RangeImage& image, bool rows_reversed, bool cols_reversed);

}  // namespace hybrid::stages
