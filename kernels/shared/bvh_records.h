// The bounding volume hierarchy of triangles and spheres as the device sees it, built by
// host/stages/rendering/bvh.cpp. All coordinates are metres relative to the scene's local origin.
#ifndef HYBRID_SHARED_BVH_RECORDS_H
#define HYBRID_SHARED_BVH_RECORDS_H
#include "shared/layout.h"

// A child is a node's index, or a leaf: the leaf bit, the kind bit (set: spheres), the number of primitives
// less one in 4 bits and the first one in 26 bits. A leaf holds primitives of one kind, consecutive in their
// array.
#define BVH_LEAF 0x80000000u
#define BVH_SPHERES 0x40000000u
#define BVH_COUNT_SHIFT 26
#define BVH_COUNT_MASK 15u
#define BVH_FIRST_MASK 0x03ffffffu
#define BVH_EMPTY 0xffffffffu
// Primitives of a leaf at most. Spheres are read that many at a time: behind the last one there is memory for
// what a full leaf would hold.
#define BVH_LARGEST_LEAF 8
// Children of a node: their boxes are tested at once, in one vector, whatever VW is.
#define BVH_WIDTH 16
// Entries of the traversal's stack: wide nodes leave BVH_WIDTH - 1 pending each, those below BVH_WIDE_LEVELS
// are binary and leave one (host/stages/rendering/bvh_collapse.cpp).
#define BVH_STACK 256
#define BVH_WIDE_LEVELS 12

// An inner node holds the boxes of its children, so that one fetch decides them all. Beyond the last child:
// BVH_EMPTY, and a box of BVH_NOWHERE to -BVH_NOWHERE, which no ray enters.
#define BVH_NOWHERE 3e38f
typedef struct BvhNode {
  float low_x[BVH_WIDTH], low_y[BVH_WIDTH], low_z[BVH_WIDTH];
  float high_x[BVH_WIDTH], high_y[BVH_WIDTH], high_z[BVH_WIDTH];
  HYBRID_UINT child[BVH_WIDTH];
} BvhNode;
LAYOUT_CHECK(BvhNode, 448);

typedef struct TriangleRecord {
  float a[3];
  HYBRID_UINT id;  // what a hit reports: 1 + face index
  float b[3];
  float radius;  // what a hit reports: 0 = a face of the model, exact; else within a scan's noise, and no
                 // more than SURFACE_POLYGON_RADIUS
  float c[3];
  float pad;
} TriangleRecord;
LAYOUT_CHECK(TriangleRecord, 48);

typedef struct SphereRecord {
  float centre[3];
  float radius;
} SphereRecord;
LAYOUT_CHECK(SphereRecord, 16);

// What a hit on a sphere reports of it, apart from the geometry that traversal reads.
typedef struct SphereSurface {
  float normal[3];  // of the sampled surface, unit; zero when unknown
  HYBRID_UINT id;   // what a hit reports: 0x80000000 + splat index
} SphereSurface;
LAYOUT_CHECK(SphereSurface, 16);

// Points of the visible surface travel between kernels as planes of `count` floats each, in this order.
#define SURFACE_X 0
#define SURFACE_Y 1
#define SURFACE_Z 2
#define SURFACE_NORMAL_X 3
#define SURFACE_NORMAL_Y 4
#define SURFACE_NORMAL_Z 5
#define SURFACE_RADIUS 6
#define SURFACE_PLANES 7
// Larger radii are samples', whose normals are estimates.
#define SURFACE_POLYGON_RADIUS 1e-6f

#endif
