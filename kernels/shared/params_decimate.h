#ifndef HYBRID_SHARED_PARAMS_DECIMATE_H
#define HYBRID_SHARED_PARAMS_DECIMATE_H
#include "shared/layout.h"

typedef struct DecimateParams {
  HYBRID_UINT first_row, first_col;  // of the tile, in samples
  HYBRID_UINT rows, cols;            // of the tile
  HYBRID_UINT square;                // side in samples
  HYBRID_UINT square_cols;
  HYBRID_UINT discard_in_mixed_squares;  // 1: labelled samples outside member squares are interior as well
  HYBRID_UINT pad;
} DecimateParams;
LAYOUT_CHECK(DecimateParams, 32);

// Values of enum SampleFate (host/stages/planes/decimate.hpp) and SquareClass
// (host/geometry/superclusters.hpp); host/stages/planes/decimate.cpp checks that they agree.
#define FATE_NO_SAMPLE 0
#define FATE_DISCARDED 1
#define FATE_BOUNDARY 2
#define FATE_NON_PLANAR_SQUARE 3
#define FATE_SMALL_PLANAR_SQUARE 4
#define FATE_OUTLIER 5
#define FATE_UNDERSAMPLED_SQUARE 6
#define CLASS_UNDERSAMPLED 0
#define CLASS_NON_PLANAR 1
#define CLASS_PLANAR_TOO_SMALL 2
#define CLASS_MEMBER 3
#define MASK_MEASURED 1

#endif
