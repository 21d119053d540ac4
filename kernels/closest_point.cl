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
#include "lib/lanes.h"
#include "shared/params_closest_point.h"

typedef struct Best {
  floatv distance2, height, fx, fy, fz;  // f = query - closest point
  uintv triangle;
} Best;

typedef struct Side {
  floatv distance2, fx, fy, fz;
} Side;

// The point of a side closest to s (= query - the side's start), as residual vector; keeps the nearer one.
static inline void try_side(Side* best, floatv sx, floatv sy, floatv sz, float ex, float ey, float ez,
                            float inverse) {
  const floatv t = clamp((sx * ex + sy * ey + sz * ez) * inverse, (floatv)(0.0f), (floatv)(1.0f));
  const floatv fx = sx - t * ex, fy = sy - t * ey, fz = sz - t * ez;
  const floatv distance2 = fx * fx + fy * fy + fz * fz;
  const intv nearer = distance2 < best->distance2;
  best->distance2 = select(best->distance2, distance2, nearer);
  best->fx = select(best->fx, fx, nearer);
  best->fy = select(best->fy, fy, nearer);
  best->fz = select(best->fz, fz, nearer);
}

static inline void try_triangle(Best* best, uint index, global const ProxyTriangle* t, floatv px, floatv py,
                                floatv pz, intv facing) {
  const floatv height = px * t->normal[0] + py * t->normal[1] + pz * t->normal[2] - t->offset;
  const intv open = facing & (height * height < best->distance2);
  if (!ANY(open)) return;

  const floatv rx = px - t->a[0], ry = py - t->a[1], rz = pz - t->a[2];
  const floatv sx = rx - t->ab[0], sy = ry - t->ab[1], sz = rz - t->ab[2];
  const intv inside = (rx * t->inward_ab[0] + ry * t->inward_ab[1] + rz * t->inward_ab[2] >= 0.0f) &
                      (sx * t->inward_bc[0] + sy * t->inward_bc[1] + sz * t->inward_bc[2] >= 0.0f) &
                      (rx * t->inward_ca[0] + ry * t->inward_ca[1] + rz * t->inward_ca[2] >= 0.0f);
  Side side = {INFINITY, 0.0f, 0.0f, 0.0f};
  if (ANY(open & !inside)) {
    try_side(&side, rx, ry, rz, t->ab[0], t->ab[1], t->ab[2], t->inverse_ab2);
    try_side(&side, sx, sy, sz, t->ac[0] - t->ab[0], t->ac[1] - t->ab[1], t->ac[2] - t->ab[2],
             t->inverse_bc2);
    try_side(&side, rx, ry, rz, t->ac[0], t->ac[1], t->ac[2], t->inverse_ca2);
  }
  const floatv distance2 = select(side.distance2, height * height, inside);
  const intv nearer = open & (distance2 < best->distance2);
  const intv nearer_inside = nearer & inside;
  best->distance2 = select(best->distance2, distance2, nearer);
  best->height = select(best->height, height, nearer);
  best->triangle = select(best->triangle, (uintv)(index), nearer);
  best->fx = select(select(best->fx, side.fx, nearer), height * t->normal[0], nearer_inside);
  best->fy = select(select(best->fy, side.fy, nearer), height * t->normal[1], nearer_inside);
  best->fz = select(select(best->fz, side.fz, nearer), height * t->normal[2], nearer_inside);
}

kernel void closest_point(ClosestPointParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const float* restrict nx, global const float* restrict ny,
                          global const float* restrict nz, global const ProxyTriangle* restrict triangles,
                          global float* restrict distance, global float* restrict height,
                          global uint* restrict triangle, global float* restrict near_x,
                          global float* restrict near_y, global float* restrict near_z) {
  const uint first = (uint)get_global_id(0) * VW, count = params.queries;
  if (first >= count) return;
  const float* m = params.linear;
  const floatv lx = load_lanes(x, first, count, NAN), ly = load_lanes(y, first, count, NAN),
               lz = load_lanes(z, first, count, NAN);
  const floatv px = lx * m[0] + ly * m[1] + lz * m[2] + params.translation[0];
  const floatv py = lx * m[3] + ly * m[4] + lz * m[5] + params.translation[1];
  const floatv pz = lx * m[6] + ly * m[7] + lz * m[8] + params.translation[2];
  const floatv sx = load_lanes(nx, first, count, NAN), sy = load_lanes(ny, first, count, NAN),
               sz = load_lanes(nz, first, count, NAN);
  const floatv mx = sx * m[0] + sy * m[1] + sz * m[2];
  const floatv my = sx * m[3] + sy * m[4] + sz * m[5];
  const floatv mz = sx * m[6] + sy * m[7] + sz * m[8];

  Best best = {params.gate2, NAN, NAN, NAN, NAN, NO_TRIANGLE};
  for (uint i = 0; i < params.triangles; ++i) {
    global const ProxyTriangle* t = triangles + i;
    // Negated, so that a NaN normal faces every triangle.
    const intv facing = !(mx * t->normal[0] + my * t->normal[1] + mz * t->normal[2] < params.min_facing);
    if (ANY(facing)) try_triangle(&best, i, t, px, py, pz, facing);
  }
  // f is NaN where nothing was found, and with it all that is computed from it.
  store_lanes(sqrt(best.fx * best.fx + best.fy * best.fy + best.fz * best.fz), distance, first, count);
  store_lanes(best.height, height, first, count);
  store_indices(best.triangle, triangle, first, count);
  store_lanes(px - best.fx, near_x, first, count);
  store_lanes(py - best.fy, near_y, first, count);
  store_lanes(pz - best.fz, near_z, first, count);
}
