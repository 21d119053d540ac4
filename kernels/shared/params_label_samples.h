#ifndef HYBRID_SHARED_PARAMS_LABEL_SAMPLES_H
#define HYBRID_SHARED_PARAMS_LABEL_SAMPLES_H
#include "shared/layout.h"

// Planes that may compete for the samples of one square; more than 8 around one square is clutter.
#define LABEL_CANDIDATES 8

typedef struct LabelParams {
  HYBRID_UINT first_row, first_col;  // of the tile, in samples
  HYBRID_UINT rows, cols;            // of the tile
  HYBRID_UINT square;                // side in samples
  HYBRID_UINT square_cols;
  float noise_m;     // k sigma: tolerance along the ray
  float waviness_m;  // tolerance along the normal
  float min_cosine;  // c: floor of |n.u|
  float pad[3];
} LabelParams;
LAYOUT_CHECK(LabelParams, 48);

// Squares side by side that a tile has samples of: work-items in a row of the grid.
#define LABEL_SQUARES_ACROSS(params) \
  (((params).first_col + (params).cols - 1) / (params).square - (params).first_col / (params).square + 1)

// A plane that competes for samples.
typedef struct LabelPlane {
  float normal[3];  // normal . x = offset, scan frame, metres
  float offset;
  HYBRID_UINT label;  // what its samples get; 0 for a curved region: winning means unassigned
  HYBRID_UINT pad[3];
} LabelPlane;
LAYOUT_CHECK(LabelPlane, 32);

#endif
