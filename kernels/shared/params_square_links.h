#ifndef HYBRID_SHARED_PARAMS_SQUARE_LINKS_H
#define HYBRID_SHARED_PARAMS_SQUARE_LINKS_H
#include "shared/layout.h"

typedef struct SquareLinkParams {
  HYBRID_UINT rows, cols;  // of squares
  HYBRID_UINT wraps;       // 1: the last column of squares neighbours the first
  float row_reach_rad;     // beta n times the elevation step
  float col_reach_rad;     // beta n times the azimuth step
  float min_cosine;        // c: floor of |n.u|
  float sigma_m;           // range noise
  float offset_sigmas;     // k of the out-of-plane and the distance test
  float angle_rad;         // alpha0
  float angle_sigmas;      // k of alpha = max(alpha0, k sigma_n)
  float pad[2];
} SquareLinkParams;
LAYOUT_CHECK(SquareLinkParams, 48);

#endif
