// Fate of every sample under the paper's decimation rule (METHOD 4, paper 2.1): interior planar samples are
// discarded; boundaries, non-planar squares, planar squares outside superclusters and outliers are kept.
// Mapping: one work-item per sample of the tile.
// in:  mask[rows * cols] of the tile (1 = measured), label[] (supercluster id, 0 = none), boundary[] (1 = on
//      a contour); square_class per square of the whole image.
// out: fate[rows * cols] of the tile (FATE_...). Nodes that are empty or interpolated: FATE_NO_SAMPLE.
// Params: DecimateParams. Edges: none (no neighbours). Cost: 7 bytes, about 10 operations per sample.
// Reference twin: tests/reference/decimate.cpp.
#include "shared/params_decimate.h"

kernel void decimate(DecimateParams params, global const uchar* restrict mask,
                     global const uint* restrict label, global const uchar* restrict boundary,
                     global const uchar* restrict square_class, global uchar* restrict fate) {
  const uint col = get_global_id(0), row = get_global_id(1);
  if (col >= params.cols || row >= params.rows) return;
  const uint i = row * params.cols + col;
  const uint kind = square_class[(params.first_row + row) / params.square * params.square_cols +
                                 (params.first_col + col) / params.square];
  uchar result = FATE_UNDERSAMPLED_SQUARE;
  if (kind == CLASS_NON_PLANAR) result = FATE_NON_PLANAR_SQUARE;
  if (kind == CLASS_PLANAR_TOO_SMALL) result = FATE_SMALL_PLANAR_SQUARE;
  if (kind == CLASS_MEMBER) result = FATE_OUTLIER;
  if (label[i] != 0u && (kind == CLASS_MEMBER || params.discard_in_mixed_squares)) result = FATE_DISCARDED;
  if (boundary[i] != 0) result = FATE_BOUNDARY;
  fate[i] = mask[i] == MASK_MEASURED ? result : FATE_NO_SAMPLE;
}
