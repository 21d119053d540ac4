#ifndef HYBRID_SHARED_PARAMS_BLEND_PHOTOS_H
#define HYBRID_SHARED_PARAMS_BLEND_PHOTOS_H
#include "shared/records.h"

#define BLEND_NEAREST 0u
#define BLEND_LINEAR 1u
#define BLEND_DUAL 2u

// Accumulated colours: planes of `cols * rows` floats each, in this order; all start at 0.
#define BLEND_SUM_R 0
#define BLEND_SUM_G 1
#define BLEND_SUM_B 2
#define BLEND_SUM_WEIGHT 3
#define BLEND_BEST_R 4
#define BLEND_BEST_G 5
#define BLEND_BEST_B 6
#define BLEND_BEST_WEIGHT 7
#define BLEND_PLANES 8

typedef struct BlendPhotosParams {
  CameraRecord camera;     // the photograph's
  float eye[3];            // where the surface is seen from
  float pixel_rad;         // angle of one pixel of the view: added to every angle
  HYBRID_UINT cols, rows;  // surface points of this launch
  HYBRID_UINT mode;        // BLEND_...
  int photograph;          // its index, reported as the best one's
  float feather_px;        // weights fall to 0 over this distance to the photograph's border; 0 = no feather
  float tolerance_m;       // between samples and faces, shadow hits this near to the surface do not count
  float face_tolerance_m;  // the same among faces, which are exact: rounding only
  HYBRID_UINT root;        // child code of the tree's root
} BlendPhotosParams;
LAYOUT_CHECK(BlendPhotosParams, sizeof(CameraRecord) + 48);

typedef struct ResolveBlendParams {
  HYBRID_UINT count;
  HYBRID_UINT mode;  // BLEND_...
  HYBRID_UINT pad[2];
} ResolveBlendParams;
LAYOUT_CHECK(ResolveBlendParams, 16);

#endif
