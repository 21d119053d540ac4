#ifndef HYBRID_SHARED_PARAMS_SQUARE_PLANES_H
#define HYBRID_SHARED_PARAMS_SQUARE_PLANES_H
#include "shared/layout.h"

#define SQUARE_BLOCK 16u       // neighbouring squares of a row that try the same triplets of samples
#define SQUARE_TRIPLETS 1024u  // in the table the triplets are drawn from; a power of two

#define SQUARE_SCORE_PAPER 0u
#define SQUARE_SCORE_MSAC 1u
#define SQUARE_FIT_RANSAC 0u
#define SQUARE_FIT_EIGEN 1u

// One tile of the image. Its first row and column are multiples of the square's side, its first square column
// a multiple of SQUARE_BLOCK.
typedef struct SquarePlanesParams {
  HYBRID_UINT rows, cols;        // of the tile, samples
  HYBRID_UINT first_square_row;  // of the tile in the image, squares
  HYBRID_UINT first_square_col;
  HYBRID_UINT hypotheses;  // test planes per square, at most SQUARE_TRIPLETS
  HYBRID_UINT seed;
  HYBRID_UINT score;       // SQUARE_SCORE_...
  HYBRID_UINT fit;         // SQUARE_FIT_...
  HYBRID_UINT min_valid;   // fewer: undersampled; at least 3
  float min_inlier_share;  // of the valid samples
  float threshold_m;       // t of METHOD 2, along the ray
  float sigma_m;           // range noise, along the ray
  float min_cosine;        // c_min: |n.u| counts as no less
  float pad[3];
} SquarePlanesParams;
LAYOUT_CHECK(SquarePlanesParams, 64);

#endif
