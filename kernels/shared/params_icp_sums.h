// Arguments of kernels/icp_sums.cl.
#ifndef HYBRID_SHARED_PARAMS_ICP_SUMS_H
#define HYBRID_SHARED_PARAMS_ICP_SUMS_H
#include "shared/layout.h"

// Sums per block, POINT 0: upper triangle of the 7x7 matrix sum w J J^T by rows (28), right side sum w J e
// (7), then the three common ones. J = (p x n, n, n . p) for rotation vector, translation and relative scale
// about the pivot, p = linear (l - centre_scan), e = height over the face.
#define ICP_PLANE_SUMS 38
// POINT 1: sum w l (3), sum w r (3), sum w l r^T by rows (9), sum w |l|^2, sum w |r|^2, then the common ones;
// l = sample - centre_scan, r = closest point - centre_local.
#define ICP_POINT_SUMS 20
// The three common ones, last: sum w; sum of areas of the inliers; sum of area times squared error of these.
#define ICP_COMMON_SUMS 3

typedef struct IcpSumsParams {
  float linear[9];  // row-major, local_from_scan: scale times rotation
  float cutoff;     // Tukey's: pairs with |error| >= cutoff have weight 0; INFINITY = every pair its area
  float centre_scan[3];
  HYBRID_UINT samples;
  float centre_local[3];
  float pad[3];
} IcpSumsParams;
LAYOUT_CHECK(IcpSumsParams, 80);

#endif
