#ifndef HYBRID_SHARED_PARAMS_BLEND_PHOTOS_H
#define HYBRID_SHARED_PARAMS_BLEND_PHOTOS_H
#include "shared/records.h"

#define BLEND_NEAREST 0u
#define BLEND_LINEAR 1u
#define BLEND_DUAL 2u

// Accumulated colours: planes of `cols * rows` floats each, in this order; all start at 0.
#define BLEND_SUM_R 0  // of light (linear) or low bands (dual), by weight
#define BLEND_SUM_G 1
#define BLEND_SUM_B 2
#define BLEND_SUM_WEIGHT 3
#define BLEND_BEST_R 4  // light of the heaviest (nearest), or sum of high bands (dual) ...
#define BLEND_BEST_G 5
#define BLEND_BEST_B 6
#define BLEND_BEST_SHARE 7   // ... by (weight / heaviest)^high_power, and the sum of those
#define BLEND_BEST_WEIGHT 8  // of the heaviest
#define BLEND_PLANES 9

// How photographs mix.
typedef struct BlendMode {
  HYBRID_UINT mode;        // BLEND_...
  HYBRID_UINT high_power;  // dual: exponent of the weights in the high band
} BlendMode;

typedef struct BlendPhotosParams {
  CameraRecord camera;     // the photograph's
  float eye[3];            // where the surface is seen from
  float pixel_rad;         // angle of one pixel of the view: added to every angle
  HYBRID_UINT cols, rows;  // surface points of this launch
  BlendMode mix;
  int photograph;          // its index, reported as the best one's
  float feather_px;        // weights fall to 0 over this distance to the photograph's border; 0 = no feather
  float tolerance_m;       // between samples and faces, shadow hits this near to the surface do not count
  float face_tolerance_m;  // the same among faces, which are exact: rounding only
  HYBRID_UINT root;        // child code of the tree's root
  float pad[3];
} BlendPhotosParams;
LAYOUT_CHECK(BlendPhotosParams, sizeof(CameraRecord) + 64);

typedef struct ResolveBlendParams {
  HYBRID_UINT count;
  HYBRID_UINT mode;  // BLEND_...
  HYBRID_UINT pad[2];
} ResolveBlendParams;
LAYOUT_CHECK(ResolveBlendParams, 16);

#endif
