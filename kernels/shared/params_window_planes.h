#ifndef HYBRID_SHARED_PARAMS_WINDOW_PLANES_H
#define HYBRID_SHARED_PARAMS_WINDOW_PLANES_H
#include "shared/range_noise.h"

// Windows tried at each sample, which is their upper left corner: square, upright, lying. Rows and columns.
#define WINDOW_SHAPES 5
#define WINDOW_ROWS(shape) \
  ((shape) == 0u ? 4u : (shape) == 1u ? 8u : (shape) == 2u ? 3u : (shape) == 3u ? 12u : 2u)
#define WINDOW_COLS(shape) \
  ((shape) == 0u ? 4u : (shape) == 1u ? 3u : (shape) == 2u ? 8u : (shape) == 3u ? 2u : 12u)
#define WINDOW_REACH 12  // the longest side: what a tile needs beyond its last row and column is one less

// One tile of the image with what its windows reach beyond it.
typedef struct WindowPlanesParams {
  HYBRID_UINT rows, cols;            // of the tile: the corners tried
  HYBRID_UINT halo_rows, halo_cols;  // of the arrays: the tile and up to WINDOW_REACH - 1 more
  float chi2_sigmas;  // chi2 may exceed its expectation by this many of its standard deviations
  float min_share;    // of a window's samples that must be free
  float min_cosine;   // planes seen at a flatter angle are none
  float pad;
  RangeNoiseRecord noise;
} WindowPlanesParams;
LAYOUT_CHECK(WindowPlanesParams, 48);

#endif
