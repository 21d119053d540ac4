// Gives every sample to the supercluster plane it fits best (METHOD 3 [+]): samples of member squares,
// of square borders and of mixed squares alike.
// Method: among the candidate planes of the sample's square, those with
//   |n.p - d| <= k sigma max(|n.u|, c) + waviness
// compete by their residual along the ray |n.p - d| / max(|n.u|, c): where a wall meets a floor seen at a
// grazing angle, that is what the noise makes likely, not the orthogonal distance. Planes of curved regions
// and the own plane of a planar square outside all regions compete too; when they win the sample stays
// unassigned.
// Mapping: one work-item per row of a square that the tile holds a part of: its samples have the same
// candidates, and where that is one plane they are compared with it side by side.
// in:  x, y, z[rows * cols] of the tile, metres, scan frame, NaN = no sample; candidates[LABEL_CANDIDATES]
//      per square of the whole image: index + 1 into planes, 0 ends the list; own_plane per square of the
//      whole image: normal and offset, normal 0 = none; planes.
// out: labels[rows * cols] of the tile: label of the winner, 0 = none (ties: the earlier candidate).
// Params: LabelParams. Cost: 16 bytes and about 15 operations per candidate and sample (one candidate
// inside a plane). Reference twin: tests/reference/label_samples.cpp.
#include "shared/params_label_samples.h"

kernel void label_samples(LabelParams params, global const float* restrict x, global const float* restrict y,
                          global const float* restrict z, global const uint* restrict candidates,
                          global const float4* restrict own_plane, global const LabelPlane* restrict planes,
                          global uint* restrict labels) {
  const uint square_col = params.first_col / params.square + get_global_id(0), row = get_global_id(1);
  const uint first = max(square_col * params.square, params.first_col) - params.first_col;
  if (first >= params.cols || row >= params.rows) return;
  const uint end = min((square_col + 1u) * params.square - params.first_col, params.cols);
  const uint square = (params.first_row + row) / params.square * params.square_cols + square_col;
  global const uint* restrict list = candidates + (size_t)square * LABEL_CANDIDATES;
  const float4 own = own_plane[square];
  const bool has_own = own.x != 0.0f || own.y != 0.0f || own.z != 0.0f;
  if (list[0] != 0u && list[1] == 0u && !has_own) {  // inside a plane, as most are: a loop for vectors
    const LabelPlane plane = planes[list[0] - 1u];
    for (uint i = row * params.cols + first; i < row * params.cols + end; ++i) {
      const float px = x[i], py = y[i], pz = z[i];
      const float range = sqrt(px * px + py * py + pz * pz);
      const float along = plane.normal[0] * px + plane.normal[1] * py + plane.normal[2] * pz;
      const float cosine = fmax(fabs(along) / range, params.min_cosine);
      labels[i] =
          fabs(along - plane.offset) <= params.noise_m * cosine + params.waviness_m ? plane.label : 0u;
    }
    return;
  }
  for (uint i = row * params.cols + first; i < row * params.cols + end; ++i) {
    uint best = 0u;
    if (list[0] != 0u) {
      const float px = x[i], py = y[i], pz = z[i];
      const float range = sqrt(px * px + py * py + pz * pz);
      float least = INFINITY;
      for (int k = 0; k < LABEL_CANDIDATES && list[k] != 0u; ++k) {
        global const LabelPlane* restrict plane = planes + (list[k] - 1u);
        const float along = plane->normal[0] * px + plane->normal[1] * py + plane->normal[2] * pz;
        const float cosine = fmax(fabs(along) / range, params.min_cosine);
        const float distance = fabs(along - plane->offset);
        // NaN: both comparisons are false.
        if (distance <= params.noise_m * cosine + params.waviness_m && distance < least * cosine) {
          least = distance / cosine;
          best = plane->label;
        }
      }
      if (best != 0u && has_own) {
        const float along = own.x * px + own.y * py + own.z * pz;
        const float cosine = fmax(fabs(along) / range, params.min_cosine);
        if (fabs(along - own.w) < least * cosine) best = 0u;
      }
    }
    labels[i] = best;
  }
}
