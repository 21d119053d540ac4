#ifndef HYBRID_SHARED_PARAMS_RESAMPLE_H
#define HYBRID_SHARED_PARAMS_RESAMPLE_H
#include "shared/layout.h"

// One tile of the grid. Row positions count rows of the whole grid from the top.
typedef struct ResampleParams {
  HYBRID_UINT first_row;   // of the tile in the grid
  HYBRID_UINT rows, cols;  // of the tile
  float step_rad;          // elevation from row to row
  float max_gap;           // rows between samples that an interpolation may bridge
  float jump_m;            // a difference in range up to this is no depth jump
  float jump_slope;        // ... plus this times the length of the arc between the samples
  float jump_factor;       // ... plus this times what the slope beside the gap predicts
} ResampleParams;
LAYOUT_CHECK(ResampleParams, 32);

#define RESAMPLE_STRIP 16u  // rows of a column that one work-item fills

#define RESAMPLE_EMPTY 0u
#define RESAMPLE_MEASURED 1u
#define RESAMPLE_INTERPOLATED 2u
#define RESAMPLE_NO_SAMPLE 0xffffffffu

#endif
