#ifndef HYBRID_SHARED_PARAMS_RANK_PHOTOS_H
#define HYBRID_SHARED_PARAMS_RANK_PHOTOS_H
#include "shared/params_blend_photos.h"

// rank_photos: the penalties of one photograph.
typedef struct RankPhotosParams {
  CameraRecord camera;     // the photograph's
  float eye[3];            // where the surface is seen from
  float pixel_ratio;       // angle of one pixel of the photograph over that of one pixel of the view
  HYBRID_UINT cols, rows;  // surface points of this launch
  HYBRID_UINT kept;        // photographs remembered per point: k + 1
  int photograph;          // its index
  float feather_px;        // its field of view ends softly over this distance to its border; 0 = sharply
  float tolerance_m;       // as in BlendPhotosParams
  float face_tolerance_m;
  HYBRID_UINT root;
  float resolution_cost;     // rad, per time that its pixel covers more surface than the view's
  float field_of_view_cost;  // rad, at its border
  float least_facing;        // as in BlendPhotosParams
  float least_facing_sample;
} RankPhotosParams;
LAYOUT_CHECK(RankPhotosParams, sizeof(CameraRecord) + 64);

// blend_ranked: adds one photograph to the points that it was ranked for.
typedef struct BlendRankedParams {
  CameraRecord camera;     // the photograph's
  HYBRID_UINT cols, rows;  // surface points of this launch
  BlendMode mix;
  int photograph;    // its index
  HYBRID_UINT kept;  // as in RankPhotosParams
  float feather_px;
  float pixel_rad;  // angle of one pixel of the view
  float pad[2];
} BlendRankedParams;
LAYOUT_CHECK(BlendRankedParams, sizeof(CameraRecord) + 64);

#endif
