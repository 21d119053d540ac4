// Arguments of kernels/closest_point.cl and closest_point_tree.cl, and the triangle record that icp_sums
// reads too.
#ifndef HYBRID_SHARED_PARAMS_CLOSEST_POINT_H
#define HYBRID_SHARED_PARAMS_CLOSEST_POINT_H
#include "shared/layout.h"

#define NO_TRIANGLE 0xffffffffu

// One triangle a b c of the model, metres in the local frame (world axes, origin near the queries). The plane
// is kept by its offset from that origin, because heights computed from a far corner would lose digits.
typedef struct ProxyTriangle {
  float normal[3];  // unit, to the front side: normal . x = offset
  float offset;
  float a[3];
  float inverse_ab2;  // 1 / |ab|^2
  float ab[3];        // b - a
  float inverse_bc2;
  float ac[3];  // c - a
  float inverse_ca2;
  float inward_ab[3];  // unit, in the plane, from the side ab into the triangle; 0 for a side without length
  HYBRID_UINT face;    // index into PolygonModel::faces
  float inward_bc[3];
  float slack;  // metres: what is not so far inside counts as beside the triangle, nearest to a side
  float inward_ca[3];
  float pad;
} ProxyTriangle;
LAYOUT_CHECK(ProxyTriangle, 112);

typedef struct ClosestPointParams {
  float linear[9];       // row-major, local_from_scan: scale times rotation
  float translation[3];  // local_from_scan
  float gate2;           // squared metres: only triangles closer than this; INFINITY = no gate
  float min_facing;      // scale times cosine of the largest angle between normals; below -scale = any angle
  HYBRID_UINT queries;
  HYBRID_UINT triangles;
  HYBRID_UINT root;  // of the tree, for closest_point_tree
  HYBRID_UINT pad[3];
} ClosestPointParams;
LAYOUT_CHECK(ClosestPointParams, 80);

#endif
