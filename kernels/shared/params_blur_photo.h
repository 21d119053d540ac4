#ifndef HYBRID_SHARED_PARAMS_BLUR_PHOTO_H
#define HYBRID_SHARED_PARAMS_BLUR_PHOTO_H
#include "shared/records.h"

typedef struct BlurPhotoParams {
  HYBRID_UINT width, height;
  HYBRID_UINT vertical;  // 0: along rows, from the photograph's bytes; 1: along columns, from the first pass
  HYBRID_UINT radius;    // taps on either side; weights[radius + 1]
  float tolerance_m;     // change of distance between neighbouring pixels that is no visibility edge ...
  float slope;           // ... plus this times the pixel's footprint, per pixel apart
  float pixel_rad;       // angle of one pixel of the photograph
  HYBRID_UINT first;     // pixel of `blurred` that the image begins at
} BlurPhotoParams;
LAYOUT_CHECK(BlurPhotoParams, 32);

#endif
