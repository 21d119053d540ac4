// The sample of one scan nearest to a point of another (METHOD 6, scan to scan), found where the scan's grid
// looks at the point: in a window of nodes as large as the gate there, or as the nearest sample around the
// node itself leaves. Only samples whose normal is compatible with the query's count; the plane through the
// sample is what the query's height is measured over. And how far the line of sight through the point goes
// beyond it: scans that are wrongly placed see through each other's surfaces. After Blais and Levine (1995),
// with a search around the projection.
// Mapping: one work-item per query and, along the second dimension, place of its scan. Windows differ in size
// and branches in outcome, so lanes would idle; the time is that of fetching nodes that lie apart, so what a
// node has lies together. in:  x y z nx ny nz [queries] scan frame, metres, unit, NaN = none; ranges [rows *
// cols] of the grid's
//      samples from its origin, NaN = none; points, normals [3 * rows * cols] of them, grid frame, unit,
//      NaN = none; block_ranges [2 * rows of blocks * columns of blocks]: the least and the largest range of
//      every CLOSEST_SAMPLE_BLOCK by CLOSEST_SAMPLE_BLOCK nodes, fewer in the last ones; infinity and
//      -infinity where there is none; row_edges [rows + 1], col_edges [cols + 1], row_starts, col_starts
//      [GRID_BINS + 1] as in lib/range_grid.h.
// out, of one place after the other: distance, height [queries] metres, to the sample and over its plane,
// above 0 on its front side;
//      normal_x normal_y normal_z [queries] of the sample, grid frame; NaN without a pair. clearance
//      [queries] metres: by how much the nearest return of the node and its 8 neighbours lies beyond the
//      query; NaN without a return there.
// params, places: params_closest_sample.h. defines: none.
// edges: the window crosses the azimuth seam where the grid wraps. A window of more than
//      CLOSEST_SAMPLE_WINDOW nodes to a side is searched in strides, which are halved about the best so far;
//      of equal distances the first one tried wins.
// cost: 24 bytes read and 24 written per query; the ranges of 9 nodes, and of up to 81 and 8 per halving
//      where blocks say that one of them may be near; 24 more per node with a range near the query's.
// reference twin: tests/reference/closest_sample.cpp
#include "lib/range_grid.h"

typedef struct SampleSearch {
  float3 point, normal;  // of the query, grid frame; the normal not unit where the scale is not 1
  float best2;           // squared distance
  int row, col;          // of the best; row -1: none
} SampleSearch;

static inline void try_sample(SampleSearch* search, float min_facing, int row, int col, int i,
                              global const float* points, global const float* normals) {
  const float3 apart = search->point - vload3((size_t)i, points);
  const float distance2 = apart.x * apart.x + apart.y * apart.y + apart.z * apart.z;
  if (!(distance2 < search->best2)) return;
  const float3 normal = vload3((size_t)i, normals);
  const float facing =
      normal.x * search->normal.x + normal.y * search->normal.y + normal.z * search->normal.z;
  if (!(facing > min_facing)) return;
  search->best2 = distance2;
  search->row = row;
  search->col = col;
}

// Every stride-th node of a window about this one. Here and below `range` is the query's: farther from it
// than `within` metres, the distance of the best, no sample's range can be.
static inline void try_strides(SampleSearch* search, const ClosestSampleParams* params, GridNode middle,
                               int rows, int cols, int row_stride, int col_stride, float range, float within,
                               global const float* ranges, global const float* points,
                               global const float* normals) {
  for (int a = -rows; a <= rows; ++a) {
    const int row = middle.row + a * row_stride;
    if (row < 0 || row >= (int)params->rows) continue;
    for (int b = -cols; b <= cols; ++b) {
      const int col = column_of(params, middle.col + b * col_stride);
      const int i = row * (int)params->cols + col;
      if (col >= 0 && fabs(ranges[i] - range) <= within)
        try_sample(search, params->min_facing, row, col, i, points, normals);
    }
  }
}

// All nodes of a window that does not cross the first or last column; of a row all ranges at once.
static inline void try_rows(SampleSearch* search, const ClosestSampleParams* params, GridNode middle,
                            int rows, int cols, float range, float within, global const float* ranges,
                            global const float* points, global const float* normals) {
  const int first = max(middle.row - rows, 0), last = min(middle.row + rows, (int)params->rows - 1);
  for (int row = first; row <= last; ++row) {
    const int i = row * (int)params->cols + middle.col;
    const float16 apart = fabs(vload16(0, ranges + i - 8) - range);
    if (!any(apart <= within)) continue;
    for (int b = -cols; b <= cols; ++b)
      if (fabs(ranges[i + b] - range) <= within)
        try_sample(search, params->min_facing, row, middle.col + b, i + b, points, normals);
  }
}

// Whether a window about this node may hold such a range, as its blocks say. Across the seam, and of so many
// blocks that asking them is no gain, it always may.
static inline int may_hold(const ClosestSampleParams* params, GridNode middle, int rows, int cols,
                           float range, float within, global const float* block_ranges) {
  const int outside = middle.col - cols < 0 || middle.col + cols >= (int)params->cols;
  if (outside && params->wraps) return 1;
  const int top = max(middle.row - rows, 0) / CLOSEST_SAMPLE_BLOCK,
            bottom = min(middle.row + rows, (int)params->rows - 1) / CLOSEST_SAMPLE_BLOCK,
            left = max(middle.col - cols, 0) / CLOSEST_SAMPLE_BLOCK,
            right = min(middle.col + cols, (int)params->cols - 1) / CLOSEST_SAMPLE_BLOCK;
  const int across = ((int)params->cols + CLOSEST_SAMPLE_BLOCK - 1) / CLOSEST_SAMPLE_BLOCK;
  if ((bottom - top) * (right - left) > CLOSEST_SAMPLE_MOST_BLOCKS) return 1;
  for (int row = top; row <= bottom; ++row)
    for (int col = left; col <= right; ++col) {
      const float2 block = vload2((size_t)(row * across + col), block_ranges);
      if (block.x - range <= within && range - block.y <= within) return 1;
    }
  return 0;
}

// How far off rows and columns are that look so steeply: a step times this is metres. Off its axis a
// pinhole's steps are smaller angles.
static inline float2 distance_of_steps(uint lens, float3 p) {
  const float up = sqrt(p.x * p.x + p.z * p.z), around = sqrt(p.x * p.x + p.y * p.y);
  if (lens == GRID_PINHOLE) return p.x * p.x / (float2)(up, around);
  return (float2)(sqrt(around * around + p.z * p.z), around);
}

// Nodes to a side that hold so many metres at this distance.
static inline int half_window(float within, float distance, float step, uint count) {
  return (int)fmin(ceil(within / (distance * step)), (float)count);
}

// The same about a point nearer to its node's ray than to others', where steps are as little as 0.8 of the
// mean.
static inline int half_window_about(float within, float distance, float step, uint count) {
  return (int)fmin(1.25f * within / (distance * step) + 0.5f, (float)count);
}

static inline int strides_of(int nodes, int stride) {
  return stride == 1 ? nodes : (nodes + stride - 1) / stride;
}

kernel void closest_sample(ClosestSampleParams params, SamplePlaces places, global const float* restrict x,
                           global const float* restrict y, global const float* restrict z,
                           global const float* restrict nx, global const float* restrict ny,
                           global const float* restrict nz, global const float* restrict ranges,
                           global const float* restrict points, global const float* restrict normals,
                           global const float* restrict block_ranges, global const float* restrict row_edges,
                           global const float* restrict col_edges, global const uint* restrict row_starts,
                           global const uint* restrict col_starts, global float* restrict distance,
                           global float* restrict height, global float* restrict normal_x,
                           global float* restrict normal_y, global float* restrict normal_z,
                           global float* restrict clearance) {
  const uint i = (uint)get_global_id(0);
  if (i >= params.queries) return;
  const uint place = (uint)get_global_id(1);
  const float* m = places.each[place].linear;
  const float* t = places.each[place].translation;
  SampleSearch search;
  search.point =
      (float3)(m[0] * x[i] + m[1] * y[i] + m[2] * z[i] + t[0], m[3] * x[i] + m[4] * y[i] + m[5] * z[i] + t[1],
               m[6] * x[i] + m[7] * y[i] + m[8] * z[i] + t[2]);
  search.normal =
      (float3)(m[0] * nx[i] + m[1] * ny[i] + m[2] * nz[i], m[3] * nx[i] + m[4] * ny[i] + m[5] * nz[i],
               m[6] * nx[i] + m[7] * ny[i] + m[8] * nz[i]);
  search.row = -1;
  search.col = -1;
  float found = NAN, over = NAN, beyond = NAN;
  float3 normal = (float3)(NAN);
  GridNode node;
  node_towards(&params, row_edges, col_edges, row_starts, col_starts, search.point, &node);
  if (node.row >= 0) {
    const float3 p = search.point;
    const float range = sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    const float2 apart = distance_of_steps(params.lens, p);
    const float gate = params.gate + params.reach * range;
    search.best2 = gate * gate;
    float nearest_return = NAN;
    for (int row = node.row - 1; row <= node.row + 1; ++row)
      for (int col = node.col - 1; col <= node.col + 1; ++col) {
        const int at = column_of(&params, col);
        if (row < 0 || row >= (int)params.rows || at < 0) continue;
        const int k = row * (int)params.cols + at;
        nearest_return = fmin(nearest_return, ranges[k]);
        if (fabs(ranges[k] - range) <= gate)
          try_sample(&search, params.min_facing, row, at, k, points, normals);
      }
    beyond = nearest_return - range;
    const float within = sqrt(search.best2);
    int rows = half_window(gate, apart.x, params.row_step, params.rows);
    int cols = half_window(gate, apart.y, params.col_step, params.cols / 2u);
    if (search.row >= 0) {
      rows = min(rows, half_window_about(within, apart.x, params.row_step, params.rows));
      cols = min(cols, half_window_about(within, apart.y, params.col_step, params.cols / 2u));
    }
    int row_stride = max(strides_of(rows, CLOSEST_SAMPLE_WINDOW), 1);
    int col_stride = max(strides_of(cols, CLOSEST_SAMPLE_WINDOW), 1);
    const int tall = strides_of(rows, row_stride), wide = strides_of(cols, col_stride);
    if (search.row >= 0 ||
        may_hold(&params, node, tall * row_stride, wide * col_stride, range, within, block_ranges)) {
      const int whole = max(row_stride, col_stride) == 1 && node.col >= 8 && node.col + 8 <= (int)params.cols;
      if (!whole)
        try_strides(&search, &params, node, tall, wide, row_stride, col_stride, range, within, ranges, points,
                    normals);
      else if (max(rows, cols) > 1)
        try_rows(&search, &params, node, rows, cols, range, within, ranges, points, normals);
    }
    while (search.row >= 0 && max(row_stride, col_stride) > 1) {
      row_stride = (row_stride + 1) / 2;
      col_stride = (col_stride + 1) / 2;
      const GridNode middle = {search.row, search.col};
      try_strides(&search, &params, middle, 1, 1, row_stride, col_stride, range, within, ranges, points,
                  normals);
    }
    if (search.row >= 0) {
      const uint k = (uint)search.row * params.cols + (uint)search.col;
      const float3 sample = vload3(k, points);
      normal = vload3(k, normals);
      found = sqrt(search.best2);
      over = (p.x - sample.x) * normal.x + (p.y - sample.y) * normal.y + (p.z - sample.z) * normal.z;
    }
  }
  const size_t answer = (size_t)place * params.queries + i;
  distance[answer] = found;
  height[answer] = over;
  normal_x[answer] = normal.x;
  normal_y[answer] = normal.y;
  normal_z[answer] = normal.z;
  clearance[answer] = beyond;
}
