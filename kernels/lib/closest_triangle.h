// The closest of the model's triangles to VW points at a time, whatever the order in which they are tried: of
// equal squared distances the lowest index wins, and no triangle counts as nearer than its plane is. So every
// order, and every way of passing over triangles that cannot win, gives the same bits.
#ifndef HYBRID_LIB_CLOSEST_TRIANGLE_H
#define HYBRID_LIB_CLOSEST_TRIANGLE_H
#include "lib/lanes.h"
#include "shared/params_closest_point.h"

#define CLOSEST_JOIN_(a, b) a##b
#define CLOSEST_JOIN(a, b) CLOSEST_JOIN_(a, b)
#if VW == 1
#define AS_INTV(value) as_int(value)
#else
#define AS_INTV(value) CLOSEST_JOIN(as_int, VW)(value)
#endif

#define ROUNDING 1e-6f  // of a dot product of floats, in parts of its terms

// A point and the normal of its plane, local frame; NaN: no point, no normal known.
typedef struct Query {
  floatv x, y, z, nx, ny, nz;
} Query;

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
  const floatv height2 = height * height;
  const intv open = facing & (height2 <= best->distance2);
  if (!ANY(open)) return;

  const floatv rx = px - t->a[0], ry = py - t->a[1], rz = pz - t->a[2];
  const floatv sx = rx - t->ab[0], sy = ry - t->ab[1], sz = rz - t->ab[2];
  // Surely inside, whatever rounding does: else a foot beyond the acute corner of a sliver would count.
  const floatv within = fmin(fmin(rx * t->inward_ab[0] + ry * t->inward_ab[1] + rz * t->inward_ab[2],
                                  sx * t->inward_bc[0] + sy * t->inward_bc[1] + sz * t->inward_bc[2]),
                             rx * t->inward_ca[0] + ry * t->inward_ca[1] + rz * t->inward_ca[2]);
  const intv inside = within >= t->slack + ROUNDING * (fabs(rx) + fabs(ry) + fabs(rz));
  Side side = {INFINITY, 0.0f, 0.0f, 0.0f};
  if (ANY(open & !inside)) {
    try_side(&side, rx, ry, rz, t->ab[0], t->ab[1], t->ab[2], t->inverse_ab2);
    try_side(&side, sx, sy, sz, t->ac[0] - t->ab[0], t->ac[1] - t->ab[1], t->ac[2] - t->ab[2],
             t->inverse_bc2);
    try_side(&side, rx, ry, rz, t->ac[0], t->ac[1], t->ac[2], t->inverse_ca2);
  }
  // Rounding may put a side nearer than the plane that it lies in.
  const floatv distance2 = select(max(side.distance2, height2), height2, inside);
  // Signed, so that an index is not below NO_TRIANGLE: at the gate is outside.
  const intv lower = (intv)((int)index) < AS_INTV(best->triangle);
  const intv nearer = open & ((distance2 < best->distance2) | ((distance2 == best->distance2) & lower));
  const intv nearer_inside = nearer & inside;
  best->distance2 = select(best->distance2, distance2, nearer);
  best->height = select(best->height, height, nearer);
  best->triangle = select(best->triangle, (uintv)(index), nearer);
  best->fx = select(select(best->fx, side.fx, nearer), height * t->normal[0], nearer_inside);
  best->fy = select(select(best->fy, side.fy, nearer), height * t->normal[1], nearer_inside);
  best->fz = select(select(best->fz, side.fz, nearer), height * t->normal[2], nearer_inside);
}

// Query `first` and the VW - 1 behind it, brought from the scan's frame into the local one.
static inline void load_queries(const ClosestPointParams* params, uint first, global const float* x,
                                global const float* y, global const float* z, global const float* nx,
                                global const float* ny, global const float* nz, Query* query) {
  const uint count = params->queries;
  const float* m = params->linear;
  const floatv lx = load_lanes(x, first, count, NAN), ly = load_lanes(y, first, count, NAN),
               lz = load_lanes(z, first, count, NAN);
  const floatv sx = load_lanes(nx, first, count, NAN), sy = load_lanes(ny, first, count, NAN),
               sz = load_lanes(nz, first, count, NAN);
  query->x = lx * m[0] + ly * m[1] + lz * m[2] + params->translation[0];
  query->y = lx * m[3] + ly * m[4] + lz * m[5] + params->translation[1];
  query->z = lx * m[6] + ly * m[7] + lz * m[8] + params->translation[2];
  query->nx = sx * m[0] + sy * m[1] + sz * m[2];
  query->ny = sx * m[3] + sy * m[4] + sz * m[5];
  query->nz = sx * m[6] + sy * m[7] + sz * m[8];
}

static inline void begin_search(float gate2, Best* best) {
  best->distance2 = gate2;
  best->height = best->fx = best->fy = best->fz = NAN;
  best->triangle = NO_TRIANGLE;
}

// Tries one triangle for the lanes whose normals it is compatible with.
static inline void try_facing(Best* best, uint index, global const ProxyTriangle* t, const Query* q,
                              float min_facing) {
  // Negated, so that a NaN normal faces every triangle.
  const intv facing = !(q->nx * t->normal[0] + q->ny * t->normal[1] + q->nz * t->normal[2] < min_facing);
  if (ANY(facing)) try_triangle(best, index, t, q->x, q->y, q->z, facing);
}

static inline void store_closest(const Best* best, const Query* q, uint first, uint count,
                                 global float* distance, global float* height, global uint* triangle,
                                 global float* near_x, global float* near_y, global float* near_z) {
  // f is NaN where nothing was found, and with it all that is computed from it.
  store_lanes(sqrt(best->fx * best->fx + best->fy * best->fy + best->fz * best->fz), distance, first, count);
  store_lanes(best->height, height, first, count);
  store_indices(best->triangle, triangle, first, count);
  store_lanes(q->x - best->fx, near_x, first, count);
  store_lanes(q->y - best->fy, near_y, first, count);
  store_lanes(q->z - best->fz, near_z, first, count);
}

#endif
