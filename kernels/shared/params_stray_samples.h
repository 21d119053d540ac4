#ifndef HYBRID_SHARED_PARAMS_STRAY_SAMPLES_H
#define HYBRID_SHARED_PARAMS_STRAY_SAMPLES_H
#include "shared/layout.h"

typedef struct StraySamplesParams {
  HYBRID_UINT rows, cols;   // of the tile; its points come with a halo of STRAY_WINDOW nodes on every side
  float noise_m;            // what noise alone makes of the difference of two ranges, k sqrt(2) sigma
  float plane_tolerance_m;  // along the ray, of a neighbour to a test plane through the sample
  float min_cosine;         // c: |n.u| counts as no less
  float steep;              // range over arc beyond which two samples are no one surface
  float gap;                // range over arc by which a mixed sample is off both surfaces
  float min_planar_share;   // of the measured neighbours, on the best test plane
  float min_near_share;     // of the measured neighbours, within `steep`
  HYBRID_UINT least_neighbours;  // fewer measured ones say nothing about isolation
  HYBRID_UINT pad[2];
} StraySamplesParams;
LAYOUT_CHECK(StraySamplesParams, 48);

#define STRAY_WINDOW 2  // neighbours up to this many nodes away are looked at

// Values of enum Stray (host/stages/scan/stray_samples.hpp), which checks that they agree.
#define STRAY_NONE 0
#define STRAY_BETWEEN 1
#define STRAY_ISOLATED 2

#endif
