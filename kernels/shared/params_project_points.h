#ifndef HYBRID_SHARED_PARAMS_PROJECT_POINTS_H
#define HYBRID_SHARED_PARAMS_PROJECT_POINTS_H
#include "shared/records.h"

typedef struct ProjectPointsParams {
  CameraRecord camera;
  HYBRID_UINT count;
  HYBRID_UINT pad[3];
} ProjectPointsParams;
LAYOUT_CHECK(ProjectPointsParams, 144);

#endif
