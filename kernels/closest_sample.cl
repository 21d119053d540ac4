// The sample of one scan nearest to a point of another (METHOD 6, scan to scan), found where the scan's grid
// looks at the point: in a window of nodes as large as the gate there. Only samples whose normal is
// compatible with the query's count; the plane through the sample is what the query's height is measured
// over. And how far the line of sight through the point goes beyond it: scans that are wrongly placed see
// through each other's surfaces. After Blais and Levine (1995), with a search around the projection.
// Mapping: one work-item per query. Windows differ in size and branches in outcome, so lanes would idle; the
// time is that of fetching nodes that lie apart.
// in:  x y z nx ny nz [queries] scan frame, metres, unit, NaN = none; px py pz qx qy qz [rows * cols] samples
//      of the grid and their unit normals, grid frame, NaN = none; row_edges [rows + 1], col_edges [cols + 1]
//      as in lib/range_grid.h.
// out: distance, height [queries] metres, to the sample and over its plane, above 0 on its front side;
//      normal_x normal_y normal_z [queries] of the sample, grid frame; NaN without a pair. clearance
//      [queries] metres: by how much the nearest return of the node and its 8 neighbours lies beyond the
//      query; NaN without a return there.
// params: params_closest_sample.h. defines: none.
// edges: the window crosses the azimuth seam where the grid wraps. A window of more than
//      CLOSEST_SAMPLE_WINDOW nodes to a side is searched in strides, which are halved about the best so far;
//      of equal distances the first in row order wins.
// cost: 24 bytes read and 24 written per query, and 12 per node tried: 9 to 81 and 8 per halving.
// reference twin: tests/reference/closest_sample.cpp
#include "lib/range_grid.h"

typedef struct SampleSearch {
  float3 point, normal;  // of the query, grid frame; the normal not unit where the scale is not 1
  float best2;           // squared distance
  int row, col;          // of the best; row -1: none
} SampleSearch;

static inline void try_node(SampleSearch* search, const ClosestSampleParams* params, int row, int col,
                            global const float* px, global const float* py, global const float* pz,
                            global const float* qx, global const float* qy, global const float* qz) {
  const int at = column_of(params, col);
  if (row < 0 || row >= (int)params->rows || at < 0) return;
  const uint i = (uint)row * params->cols + (uint)at;
  const float3 apart = search->point - (float3)(px[i], py[i], pz[i]);
  const float distance2 = apart.x * apart.x + apart.y * apart.y + apart.z * apart.z;
  if (!(distance2 < search->best2)) return;
  const float facing = qx[i] * search->normal.x + qy[i] * search->normal.y + qz[i] * search->normal.z;
  if (!(facing > params->min_facing)) return;
  search->best2 = distance2;
  search->row = row;
  search->col = at;
}

// Nodes to a side that hold `gate` metres at this distance.
static inline int half_window(float gate, float distance, float step, uint count) {
  return (int)fmin(ceil(gate / (distance * step)), (float)count);
}

// Nearest return around the node, from the grid's origin; NaN without any.
static inline float nearest_return(const ClosestSampleParams* params, GridNode node, global const float* px,
                                   global const float* py, global const float* pz) {
  float least = NAN;
  for (int row = node.row - 1; row <= node.row + 1; ++row)
    for (int col = node.col - 1; col <= node.col + 1; ++col) {
      const int at = column_of(params, col);
      if (row < 0 || row >= (int)params->rows || at < 0) continue;
      const uint i = (uint)row * params->cols + (uint)at;
      least = fmin(least, sqrt(px[i] * px[i] + py[i] * py[i] + pz[i] * pz[i]));
    }
  return least;
}

kernel void closest_sample(ClosestSampleParams params, global const float* restrict x,
                           global const float* restrict y, global const float* restrict z,
                           global const float* restrict nx, global const float* restrict ny,
                           global const float* restrict nz, global const float* restrict px,
                           global const float* restrict py, global const float* restrict pz,
                           global const float* restrict qx, global const float* restrict qy,
                           global const float* restrict qz, global const float* restrict row_edges,
                           global const float* restrict col_edges, global float* restrict distance,
                           global float* restrict height, global float* restrict normal_x,
                           global float* restrict normal_y, global float* restrict normal_z,
                           global float* restrict clearance) {
  const uint i = (uint)get_global_id(0);
  if (i >= params.queries) return;
  const float* m = params.linear;
  const float* t = params.translation;
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
  const GridNode node = node_towards(&params, row_edges, col_edges, search.point);
  if (node.row >= 0) {
    const float3 p = search.point;
    const float range = sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    const float across = params.lens == GRID_PINHOLE ? range : sqrt(p.x * p.x + p.y * p.y);
    const float gate = params.gate + params.reach * range;
    beyond = nearest_return(&params, node, px, py, pz) - range;
    search.best2 = gate * gate;
    const int rows = half_window(gate, range, params.row_step, params.rows);
    const int cols = half_window(gate, across, params.col_step, params.cols / 2u);
    int row_stride = max((rows + CLOSEST_SAMPLE_WINDOW - 1) / CLOSEST_SAMPLE_WINDOW, 1);
    int col_stride = max((cols + CLOSEST_SAMPLE_WINDOW - 1) / CLOSEST_SAMPLE_WINDOW, 1);
    const int most_rows = (rows + row_stride - 1) / row_stride,
              most_cols = (cols + col_stride - 1) / col_stride;
    for (int a = -most_rows; a <= most_rows; ++a)
      for (int b = -most_cols; b <= most_cols; ++b)
        try_node(&search, &params, node.row + a * row_stride, node.col + b * col_stride, px, py, pz, qx, qy,
                 qz);
    while (search.row >= 0 && max(row_stride, col_stride) > 1) {
      row_stride = (row_stride + 1) / 2;
      col_stride = (col_stride + 1) / 2;
      const int row = search.row, col = search.col;
      for (int a = -1; a <= 1; ++a)
        for (int b = -1; b <= 1; ++b)
          try_node(&search, &params, row + a * row_stride, col + b * col_stride, px, py, pz, qx, qy, qz);
    }
    if (search.row >= 0) {
      const uint k = (uint)search.row * params.cols + (uint)search.col;
      normal = (float3)(qx[k], qy[k], qz[k]);
      found = sqrt(search.best2);
      over = (p.x - px[k]) * normal.x + (p.y - py[k]) * normal.y + (p.z - pz[k]) * normal.z;
    }
  }
  distance[i] = found;
  height[i] = over;
  normal_x[i] = normal.x;
  normal_y[i] = normal.y;
  normal_z[i] = normal.z;
  clearance[i] = beyond;
}
