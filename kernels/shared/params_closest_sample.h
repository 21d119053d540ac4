// Arguments of kernels/closest_sample.cl.
#ifndef HYBRID_SHARED_PARAMS_CLOSEST_SAMPLE_H
#define HYBRID_SHARED_PARAMS_CLOSEST_SAMPLE_H
#include "shared/layout.h"

// Nodes on either side of the one that looks at a query that the first pass tries, at most.
#define CLOSEST_SAMPLE_WINDOW 4

// What rows and columns count by (lib/range_grid.h).
#define GRID_SPHERICAL 0
#define GRID_PINHOLE 1

typedef struct ClosestSampleParams {
  float linear[9];       // row-major, grid_from_scan: scale times rotation
  float translation[3];  // grid_from_scan
  float gate;            // metres: only samples closer than this and ...
  float reach;           // ... this per metre of range, as samples lie apart
  float min_facing;      // scale times cosine of the largest angle between normals
  float row_step;        // mean, radians (pinhole: of the measures)
  float col_step;
  HYBRID_UINT queries;
  HYBRID_UINT rows;
  HYBRID_UINT cols;
  HYBRID_UINT wraps;  // 1: the last column neighbours the first one
  HYBRID_UINT lens;   // GRID_...
  HYBRID_UINT pad[2];
} ClosestSampleParams;
LAYOUT_CHECK(ClosestSampleParams, 96);

#endif
