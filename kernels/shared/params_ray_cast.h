#ifndef HYBRID_SHARED_PARAMS_RAY_CAST_H
#define HYBRID_SHARED_PARAMS_RAY_CAST_H
#include "shared/records.h"

typedef struct RayCastParams {
  CameraRecord camera;     // its centre is the origin of all rays; the rest is read only when use_camera is 1
  HYBRID_UINT cols, rows;  // rays of this launch
  HYBRID_UINT first_col, first_row;  // pixel of ray (0,0) in the camera's image
  float offset_x, offset_y;          // position of the ray in its pixel; (0.5, 0.5) = the centre
  float tolerance_m;                 // a sphere this far behind a triangle still wins over it
  HYBRID_UINT root;                  // child code of the tree's root, BVH_EMPTY for an empty scene
  HYBRID_UINT use_camera;            // 0: directions are given
  HYBRID_UINT want_surface;          // 0: `surface` is not written
  HYBRID_UINT rays_per_origin;       // 0: one origin; else so many directions share one of their own
  HYBRID_UINT pad;
} RayCastParams;
LAYOUT_CHECK(RayCastParams, 176);

#endif
