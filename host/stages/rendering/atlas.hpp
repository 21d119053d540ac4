#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/polygon_model.hpp"

namespace hybrid::stages {

// One side of one face, flattened into its own plane: a rectangle of square texels that lies in a page of the
// atlas. The centre of texel (col, row) is the surface point origin + (col + 0.5) texel_m across +
// (row + 0.5) texel_m down; the face's outline keeps half a texel from the rectangle's border, so that
// bilinear lookups on the face touch no other texels but those of the chart.
struct AtlasChart {
  bool contour = false;    // of RenderScene::contours, else of the proxy
  std::uint32_t face = 0;  // its index there
  bool back = false;       // seen from behind: the normal is the face's, turned
  Vec3 origin = Vec3::Zero();
  Vec3 across = Vec3::UnitX(), down = Vec3::UnitY(), normal = Vec3::UnitZ();  // unit, world
  double width_m = 0, height_m = 0;                                           // of the face's rectangle
  double texel_m = 0;
  int cols = 0, rows = 0;      // without padding
  int page = 0, x = 0, y = 0;  // where texel (0, 0) lies

  Vec3 point(double col, double row) const { return origin + texel_m * (col * across + row * down); }
  // Where a point of the face's plane lies, in texels from the rectangle's corner.
  Vec2 position(const Vec3& point) const {
    return {(point - origin).dot(across) / texel_m, (point - origin).dot(down) / texel_m};
  }
};

// A chart of the face's front or back, without size or place. Walls stand upright in it; any other face lies
// as its smallest rectangle. Throws what face_plane() throws.
AtlasChart make_chart(const PolygonModel& model, std::uint32_t face, bool contour, bool back);

// Sets texel size and extent; the texel grows where the chart would have more than `most` texels on a side.
void size_chart(AtlasChart& chart, double texel_m, int most);

// Which texel centres lie on the face (even-odd over all its rings): cols x rows, row by row.
std::vector<std::uint8_t> chart_mask(const AtlasChart& chart, const PolygonModel& model);

struct AtlasLayout {
  std::vector<std::array<int, 2>> pages;  // width, height
  double enlarged = 1;                    // by which all texels grew so that the pages suffice
};

// Places the charts, which size_chart must have sized, with `padding` texels around each, on as few pages of
// at most `page` x `page` texels: skyline packing, tallest first. Where more than `pages` would be needed all
// texels grow by one factor until they suffice. A single page is as small as it can be. The same input gives
// the same layout. Throws ErrorKind::input when not even charts of single texels fit.
AtlasLayout place_charts(std::vector<AtlasChart>& charts, int page, int pages, int padding);

}  // namespace hybrid::stages
