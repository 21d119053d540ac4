// Scan columns to grid nodes (Lamond and Watson 2004, section 2.1; METHOD 1): a node takes the measured
// sample nearest to it within half a row, else a value interpolated linearly in range between the column's
// adjacent samples, where no depth jump lies between them. Mapping: one work-item per node, x = column, y =
// row of the tile. in:  begin[cols + 1]        column c holds samples begin[c] .. begin[c + 1] - 1
//      position[samples]      row position in the whole grid, ascending within a column
//      sample[samples]        measured point, scan frame, metres; w = its range
//      ray_row[rows]          cos and sin of each row's elevation; ray_col[cols] of each column's azimuth
// out: range, x, y, z [rows * cols] metres, scan frame, NaN where empty; mask: RESAMPLE_...;
//      pick: index of the measured sample, RESAMPLE_NO_SAMPLE for the others
// A sample belongs to the one row floor(position + 0.5), so two nodes never take the same; equal distances:
// the first. A depth jump is a difference in range above jump_m + (jump_slope + jump_factor * s) * arc, arc =
// smaller range * angle between the samples, s = the smaller of the slopes |dr| / arc above and below the gap
// (the local incidence; 0 where neither is known). Edges: a column without samples gives empty nodes; the
// host passes samples to 2 max_gap + 2 rows beyond the tile, so that the tiling changes nothing. Cost: 21
// bytes written, 20 bytes and log2(samples of the column) positions read per node. Reference twin:
// tests/reference/resample.cpp.
#include "shared/params_resample.h"

// First sample in [from, to) whose position is not before `value`; `to` when there is none.
static inline uint first_not_before(global const float* position, uint from, uint to, float value) {
  while (from < to) {
    const uint middle = from + (to - from) / 2u;
    if (position[middle] < value)
      from = middle + 1u;
    else
      to = middle;
  }
  return from;
}

static inline float slope(float range_a, float range_b, float rows, float step_rad) {
  return fabs(range_a - range_b) / (fmin(range_a, range_b) * rows * step_rad);
}

// Slope along the column beside sample `at`, away from the gap (direction -1: above, 1: below), from the
// first sample at least half a row away; INFINITY where there is none within max_gap.
static inline float slope_beside(global const float* position, global const float4* sample, int at,
                                 int direction, int from, int to, const ResampleParams* p) {
  for (int k = at + direction; k >= from && k < to; k += direction) {
    const float rows = fabs(position[k] - position[at]);
    if (rows > p->max_gap) break;
    if (rows >= 0.5f) return slope(sample[at].w, sample[k].w, rows, p->step_rad);
  }
  return INFINITY;
}

static inline int bridges(global const float* position, global const float4* sample, int above, int below,
                          int from, int to, const ResampleParams* p) {
  const float rows = position[below] - position[above];
  if (rows > p->max_gap) return 0;
  float beside = fmin(slope_beside(position, sample, above, -1, from, to, p),
                      slope_beside(position, sample, below, 1, from, to, p));
  if (isinf(beside)) beside = 0.0f;
  const float a = sample[above].w, b = sample[below].w;
  const float arc = fmin(a, b) * rows * p->step_rad;
  return fabs(a - b) <= p->jump_m + (p->jump_slope + p->jump_factor * beside) * arc;
}

kernel void resample(ResampleParams params, global const uint* restrict begin,
                     global const float* restrict position, global const float4* restrict sample,
                     global const float2* restrict ray_row, global const float2* restrict ray_col,
                     global float* restrict range, global float* restrict x, global float* restrict y,
                     global float* restrict z, global uchar* restrict mask, global uint* restrict pick) {
  const uint col = get_global_id(0), first_row = get_global_id(1) * RESAMPLE_STRIP;
  if (col >= params.cols || first_row >= params.rows) return;
  const uint from = begin[col], to = begin[col + 1u];
  const uint last_row = min(first_row + RESAMPLE_STRIP, params.rows);
  // First sample of the row at hand or, where it has none, below it.
  uint first = first_not_before(position, from, to, (float)(params.first_row + first_row) - 0.5f);
  for (uint row = first_row; row < last_row; ++row) {
    const float at = (float)(params.first_row + row);
    uint nearest = RESAMPLE_NO_SAMPLE, next = first;
    float distance = INFINITY;
    for (; next < to && position[next] < at + 0.5f; ++next) {
      const float off = fabs(position[next] - at);
      if (off >= distance) continue;
      distance = off;
      nearest = next;
    }

    const uint node = row * params.cols + col;
    float4 value = (float4)(NAN);
    uchar state = RESAMPLE_EMPTY;
    if (nearest != RESAMPLE_NO_SAMPLE) {
      value = sample[nearest];
      state = RESAMPLE_MEASURED;
    } else if (first > from && first < to &&
               bridges(position, sample, (int)first - 1, (int)first, (int)from, (int)to, &params)) {
      const float a = position[first - 1u], b = position[first];
      const float share = (at - a) / (b - a);
      const float r = sample[first - 1u].w + share * (sample[first].w - sample[first - 1u].w);
      const float2 elevation = ray_row[row], azimuth = ray_col[col];
      value = (float4)(r * elevation.x * azimuth.x, r * elevation.x * azimuth.y, r * elevation.y, r);
      state = RESAMPLE_INTERPOLATED;
    }
    range[node] = value.w;
    x[node] = value.x;
    y[node] = value.y;
    z[node] = value.z;
    mask[node] = state;
    pick[node] = nearest;
    first = next;
  }
}
