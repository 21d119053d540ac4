#ifndef HYBRID_SHARED_PARAMS_CONTOUR_CELLS_H
#define HYBRID_SHARED_PARAMS_CONTOUR_CELLS_H
#include "shared/layout.h"

typedef struct ContourCellParams {
  HYBRID_UINT rows, cols;  // of cells; the labels have one row and one column more
  HYBRID_UINT pad[2];
} ContourCellParams;
LAYOUT_CHECK(ContourCellParams, 16);

#endif
