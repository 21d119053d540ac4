// Closest point on the model's triangles (METHOD 6; Besl and McKay 1992) among those whose front side faces
// the way the query's normal does. Squared distances come from residual vectors: the expanded form cancels.
// Mapping: one work-item per VW queries, one query per lane, brute force over all triangles in index order.
// A triangle whose plane is already farther than the best so far is passed over; that is decided lane by
// lane, so that no query's result depends on its neighbours.
// in:  x y z [queries] scan frame, metres, NaN = no sample; nx ny nz [queries] unit normals, scan frame, NaN
//      = none known: every triangle is compatible; triangles [triangles] local frame.
// out: distance [queries] metres; height [queries] signed distance to the closest triangle's plane, positive
//      on its front side; triangle [queries]; near_x near_y near_z [queries] closest point, local frame.
//      Nothing compatible within the gate, or a NaN query: NaN and NO_TRIANGLE.
// params: params_closest_point.h. defines: VW lanes.
// edges: 0 triangles -> all NaN; of equal distances the lowest triangle index wins.
// cost: 24 bytes read and 24 written per query; 12 flops per triangle passed over, about 95 per other one.
// reference twin: tests/reference/closest_point.cpp
#include "lib/closest_triangle.h"

kernel void closest_point(ClosestPointParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const float* restrict nx, global const float* restrict ny,
                          global const float* restrict nz, global const ProxyTriangle* restrict triangles,
                          global float* restrict distance, global float* restrict height,
                          global uint* restrict triangle, global float* restrict near_x,
                          global float* restrict near_y, global float* restrict near_z) {
  const uint first = (uint)get_global_id(0) * VW;
  if (first >= params.queries) return;
  Query query;
  load_queries(&params, first, x, y, z, nx, ny, nz, &query);
  Best best;
  begin_search(params.gate2, &best);
  for (uint i = 0; i < params.triangles; ++i) try_facing(&best, i, triangles + i, &query, params.min_facing);
  store_closest(&best, &query, first, params.queries, distance, height, triangle, near_x, near_y, near_z);
}
