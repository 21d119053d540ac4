// Sums of one ICP step over the pairs sample / closest point (METHOD 6): the normal equations of the
// point-to-plane step, or what Horn's closed form needs (POINT 1; Horn 1987). Weights: area times Tukey's
// biweight (1 - (e / cutoff)^2)^2 of the pair's error e.
// Mapping: one work-item per BLOCK consecutive samples, blocks anchored at sample 0; lane k adds up the
// block's samples k, k + VW, ...; the lanes are added first to last. The host adds the blocks in double.
// in:  x y z area [samples] scan frame, metres, m2; error [samples] metres, signed or not, NaN = no pair
//      (height or distance of closest_point); triangle, near_x near_y near_z [samples] of closest_point;
//      triangles [...] its records. NORMALS 1: near_x near_y near_z are the pairs' unit normals instead, in
//      the axes of `linear`, as closest_sample has them; triangle and triangles are not read.
// out: partial [ceil(samples / BLOCK)][ICP_PLANE_SUMS or ICP_POINT_SUMS] as in params_icp_sums.h.
// params: params_icp_sums.h. defines: VW lanes, BLOCK samples per work-item, POINT 0 plane step / 1 Horn,
// NORMALS 0 the triangles' / 1 given with the pairs (plane step).
// edges: pairs with a NaN error, or a NaN sample, add nothing.
// cost: 20 to 28 bytes read per sample plus one triangle's normal; 110 (plane) or 60 flops.
// reference twin: tests/reference/icp_sums.cpp
#include "lib/lanes.h"
#include "shared/params_closest_point.h"
#include "shared/params_icp_sums.h"
#ifndef BLOCK
#define BLOCK 256
#endif
#ifndef POINT
#define POINT 0
#endif
#ifndef NORMALS
#define NORMALS 0
#endif
#if POINT
#define SUMS ICP_POINT_SUMS
#else
#define SUMS ICP_PLANE_SUMS
#endif

#if POINT
static inline void add_pair(floatv* sums, floatv w, const floatv* l, const floatv* r) {
  floatv wl[3];
  for (int a = 0; a < 3; ++a) {
    wl[a] = w * l[a];
    sums[a] += wl[a];
    sums[3 + a] += w * r[a];
  }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) sums[6 + 3 * a + b] += wl[a] * r[b];
  sums[15] += w * (l[0] * l[0] + l[1] * l[1] + l[2] * l[2]);
  sums[16] += w * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
}
#else
static inline void add_pair(floatv* sums, floatv w, const floatv* p, const floatv* n, floatv error) {
  const floatv j[7] = {p[1] * n[2] - p[2] * n[1],
                       p[2] * n[0] - p[0] * n[2],
                       p[0] * n[1] - p[1] * n[0],
                       n[0],
                       n[1],
                       n[2],
                       p[0] * n[0] + p[1] * n[1] + p[2] * n[2]};
  int k = 0;
  for (int a = 0; a < 7; ++a) {
    const floatv wj = w * j[a];
    for (int b = a; b < 7; ++b) sums[k++] += wj * j[b];
    sums[28 + a] += wj * error;
  }
}
#endif

#if !POINT && !NORMALS
static inline void gather_normals(floatv* n, global const uint* triangle,
                                  global const ProxyTriangle* triangles, uint first, uint count) {
  float lane[3][VW];
  for (uint k = 0; k < VW; ++k) {
    const uint i = first + k < count ? triangle[first + k] : NO_TRIANGLE;
    for (int a = 0; a < 3; ++a) lane[a][k] = i == NO_TRIANGLE ? 0.0f : triangles[i].normal[a];
  }
  for (int a = 0; a < 3; ++a) n[a] = LOAD_LANES(lane[a]);
}
#endif

kernel void icp_sums(IcpSumsParams params, global const float* restrict x, global const float* restrict y,
                     global const float* restrict z, global const float* restrict area,
                     global const float* restrict error, global const uint* restrict triangle,
                     global const float* restrict near_x, global const float* restrict near_y,
                     global const float* restrict near_z, global const ProxyTriangle* restrict triangles,
                     global float* restrict partial) {
  const uint block = (uint)get_global_id(0), count = params.samples;
  const uint begin = block * BLOCK;
  if (begin >= count) return;
  const uint end = min(begin + BLOCK, count);
  floatv sums[SUMS];
  for (int k = 0; k < SUMS; ++k) sums[k] = (floatv)(0.0f);
  for (uint first = begin; first < end; first += VW) {
    const floatv found = load_lanes(error, first, end, NAN);
    // Values of lanes without a pair become 0, because 0 * NaN would poison the sums.
    const intv paired = found == found;
    const floatv zero = (floatv)(0.0f), e = select(zero, found, paired);
    const floatv a = select(zero, load_lanes(area, first, end, 0.0f), paired);
    const floatv l[3] = {select(zero, load_lanes(x, first, end, 0.0f) - params.centre_scan[0], paired),
                         select(zero, load_lanes(y, first, end, 0.0f) - params.centre_scan[1], paired),
                         select(zero, load_lanes(z, first, end, 0.0f) - params.centre_scan[2], paired)};
    const floatv u = e / params.cutoff, rest = 1.0f - u * u;
    const floatv inlier_area = select(zero, a, rest > 0.0f);
    const floatv w = inlier_area * rest * rest;
#if POINT
    const floatv r[3] = {select(zero, load_lanes(near_x, first, end, 0.0f) - params.centre_local[0], paired),
                         select(zero, load_lanes(near_y, first, end, 0.0f) - params.centre_local[1], paired),
                         select(zero, load_lanes(near_z, first, end, 0.0f) - params.centre_local[2], paired)};
    add_pair(sums, w, l, r);
#else
    const float* m = params.linear;
    floatv p[3], n[3];
    for (int k = 0; k < 3; ++k) p[k] = l[0] * m[3 * k] + l[1] * m[3 * k + 1] + l[2] * m[3 * k + 2];
#if NORMALS
    n[0] = select(zero, load_lanes(near_x, first, end, 0.0f), paired);
    n[1] = select(zero, load_lanes(near_y, first, end, 0.0f), paired);
    n[2] = select(zero, load_lanes(near_z, first, end, 0.0f), paired);
#else
    gather_normals(n, triangle, triangles, first, end);
#endif
    add_pair(sums, w, p, n, e);
#endif
    sums[SUMS - 3] += w;
    sums[SUMS - 2] += inlier_area;
    sums[SUMS - 1] += inlier_area * e * e;
  }
  for (int k = 0; k < SUMS; ++k) partial[block * SUMS + k] = sum_lanes(sums[k]);
}
