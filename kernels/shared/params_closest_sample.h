// Arguments of kernels/closest_sample.cl.
#ifndef HYBRID_SHARED_PARAMS_CLOSEST_SAMPLE_H
#define HYBRID_SHARED_PARAMS_CLOSEST_SAMPLE_H
#include "shared/layout.h"

// Nodes on either side of the one that looks at a query that the first pass tries, at most.
#define CLOSEST_SAMPLE_WINDOW 4

// Nodes to a side of a block whose least and largest range are known, and of how many blocks a window asks
// for these, at most about.
#define CLOSEST_SAMPLE_BLOCK 8
#define CLOSEST_SAMPLE_MOST_BLOCKS 64

// Bins over the edges between rows, or columns: which edges lie in one is looked up, not searched for.
#define GRID_BINS 1024

// What rows and columns count by (lib/range_grid.h).
#define GRID_SPHERICAL 0
#define GRID_PINHOLE 1

// grid_from_scan of so many places, or fewer, that are asked about at once.
#define CLOSEST_SAMPLE_PLACES 16
typedef struct SamplePlace {
  float linear[9];  // row-major: scale times rotation
  float translation[3];
} SamplePlace;
typedef struct SamplePlaces {
  SamplePlace each[CLOSEST_SAMPLE_PLACES];
} SamplePlaces;
LAYOUT_CHECK(SamplePlaces, 768);

typedef struct ClosestSampleParams {
  float gate;        // metres: only samples closer than this and ...
  float reach;       // ... this per metre of range, as samples lie apart
  float min_facing;  // scale times cosine of the largest angle between normals
  float row_step;    // mean, radians (pinhole: of the measures)
  float col_step;
  HYBRID_UINT queries;
  HYBRID_UINT rows;
  HYBRID_UINT cols;
  HYBRID_UINT wraps;  // 1: the last column neighbours the first one
  HYBRID_UINT lens;   // GRID_...
  float row_bins;     // per unit of the measure
  float col_bins;
} ClosestSampleParams;
LAYOUT_CHECK(ClosestSampleParams, 48);

#endif
