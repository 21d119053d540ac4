#ifndef HYBRID_SHARED_PARAMS_BLEND_PHOTOS_H
#define HYBRID_SHARED_PARAMS_BLEND_PHOTOS_H
#include "shared/records.h"

#define BLEND_NEAREST 0u
#define BLEND_LINEAR 1u
#define BLEND_BANDS 2u  // frequency bands, each with weights of its own: dual is the case of two

#define BLEND_MAX_BANDS 7

// Accumulated colours: planes of `cols * rows` floats each, in this order; all start at 0.
#define BLEND_SUM_R 0  // of light (linear) or lowest bands (bands), by weight
#define BLEND_SUM_G 1
#define BLEND_SUM_B 2
#define BLEND_SUM_WEIGHT 3
#define BLEND_BEST_R 4  // light of the heaviest (nearest), or sum of the highest bands (bands) ...
#define BLEND_BEST_G 5
#define BLEND_BEST_B 6
#define BLEND_BEST_SHARE 7   // ... by (weight / heaviest)^power, and the sum of those
#define BLEND_BEST_WEIGHT 8  // of the heaviest
#define BLEND_PLANES 9
// R, G, B and share of every band between the highest and the lowest follow, the higher first.
#define BLEND_BAND_PLANES 4

// How photographs mix.
typedef struct BlendMode {
  HYBRID_UINT mode;                        // BLEND_...
  HYBRID_UINT bands;                       // BLEND_BANDS: 2..BLEND_MAX_BANDS; else ignored
  HYBRID_UINT power[BLEND_MAX_BANDS - 1];  // exponents of the weights, highest band first; the lowest's is 1
} BlendMode;
LAYOUT_CHECK(BlendMode, 32);

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
  float least_facing;      // at the cosine (between sight and normal) of no more than this it sees nothing
  float least_facing_sample;  // the same of samples
  float pad[3];
} BlendPhotosParams;
LAYOUT_CHECK(BlendPhotosParams, sizeof(CameraRecord) + 96);

typedef struct ResolveBlendParams {
  HYBRID_UINT count;
  HYBRID_UINT mode;   // BLEND_...
  HYBRID_UINT bands;  // as in BlendMode
  HYBRID_UINT pad;
} ResolveBlendParams;
LAYOUT_CHECK(ResolveBlendParams, 16);

#endif
