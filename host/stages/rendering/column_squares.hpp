#pragma once
#include <vector>

#include "geometry/cylinder.hpp"
#include "stages/rendering/flat_polygon.hpp"

namespace hybrid::stages {

// Whether something belongs to a column's base or to its head.
enum class ColumnEndKind { kNone, kBase, kHead };

// Plinths and abaci, whole: what is square about the column's axis has four sides as wide as they are apart,
// and a top about the shaft if it is a base, an underside if it is a head. `seen`: polygons at one end (world
// frame, front side outwards). Of those that are upright count the ones no wider than a square may be as far
// from the axis, that reach one of its corners; sides of one square, which differ by a quarter of a turn or
// are parts of one, are taken together. Those across the axis say where such sides end. Front sides outwards.
std::vector<SpacePolygon> column_squares(const Cylinder& column, ColumnEndKind end,
                                         const std::vector<SpacePolygon>& seen);

}  // namespace hybrid::stages
