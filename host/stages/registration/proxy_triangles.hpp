#pragma once
#include <optional>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "shared/params_closest_point.h"

namespace hybrid::stages {

inline constexpr std::size_t kTriangleBatch = 4096;  // of a model, that a thread takes at once

// The model's triangles as closest_point reads them, relative to `origin` (world, metres), which should lie
// near the queries: the device computes in float. Triangles of a face that is planar to 1e-4 of its extent
// carry the face's normal, so that slivers have a good one; others their own. Order of triangulate(). Throws
// what triangulate() throws, and ErrorKind::input for a model without faces.
std::vector<ProxyTriangle> proxy_triangles(const PolygonModel& model, const Vec3& origin);

// The same in steps: what does not depend on the origin is made once.
struct ProxyFacets {
  std::vector<Triangle> triangles;
  std::vector<std::optional<Vec3>> normals;  // per face: its common normal
};
ProxyFacets proxy_facets(const PolygonModel& model);
std::vector<ProxyTriangle> proxy_triangles(const PolygonModel& model, const ProxyFacets& facets,
                                           const Vec3& origin);

}  // namespace hybrid::stages
