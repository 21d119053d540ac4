// Which node of a range image looks at a point, from tables of the edges between its rows and its columns.
// Directions are measured without an angle: by quotients that grow with it, which are the same bits on every
// device. Elevation: z / (|z| + |xy|), -1 .. 1. Azimuth: y / (|x| + |y|) and on by the quarter, 4 per turn.
// Pinhole, x ahead: z / x and -y / x.
#ifndef HYBRID_LIB_RANGE_GRID_H
#define HYBRID_LIB_RANGE_GRID_H
#include "shared/params_closest_sample.h"

static inline float row_measure(uint lens, float3 p) {
  if (lens == GRID_PINHOLE) return p.z / p.x;
  return p.z / (fabs(p.z) + sqrt(p.x * p.x + p.y * p.y));
}

static inline float col_measure(uint lens, float3 p) {
  if (lens == GRID_PINHOLE) return -p.y / p.x;
  const float quarter = p.y / (fabs(p.x) + fabs(p.y));
  return p.x >= 0.0f ? quarter : p.y >= 0.0f ? 2.0f - quarter : -2.0f - quarter;
}

// Of edges, ascending: how many are at most `value`, less one. starts[b], GRID_BINS + 1 of them: how many lie
// in bins before b, of which `per_unit` begin at the first edge in every unit of the measure.
static inline int last_edge(global const float* edges, global const uint* starts, float per_unit, float value,
                            float sign) {
  const float at = (value - sign * edges[0]) * per_unit;
  const int bin = at > 0.0f ? (int)fmin(at, GRID_BINS - 1.0f) : 0;
  uint low = starts[bin], high = starts[bin + 1];
  while (low < high) {
    const uint middle = (low + high) / 2u;
    if (sign * edges[middle] <= value)
      low = middle + 1u;
    else
      high = middle;
  }
  return (int)low - 1;
}

typedef struct GridNode {
  int row, col;  // -1: the point lies more than a step outside the grid
} GridNode;

// row_edges[rows + 1] descending, col_edges[cols + 1] ascending, and their starts. (Not returned: of structs
// that inlined functions return the compiler leaves hints that oclgrind does not know.)
static inline void node_towards(const ClosestSampleParams* params, global const float* row_edges,
                                global const float* col_edges, global const uint* row_starts,
                                global const uint* col_starts, float3 p, GridNode* node) {
  node->row = -1;
  node->col = -1;
  const int rows = (int)params->rows, cols = (int)params->cols;
  const float up = row_measure(params->lens, p);
  float around = col_measure(params->lens, p);
  if (up != up || around != around || (params->lens == GRID_PINHOLE && !(p.x > 0.0f))) return;
  int row = last_edge(row_edges, row_starts, params->row_bins, -up, -1.0f);
  if (row < 0) row = up - row_edges[0] <= row_edges[0] - row_edges[1] ? 0 : -1;
  if (row >= rows) row = row_edges[rows] - up <= row_edges[rows - 1] - row_edges[rows] ? rows - 1 : -1;
  if (row < 0) return;
  const int turns = params->lens == GRID_SPHERICAL;  // on past the last column comes the first
  if (turns) around += 4.0f * ceil((col_edges[0] - around) / 4.0f);
  int col = last_edge(col_edges, col_starts, params->col_bins, around, 1.0f);
  if (col < 0 || col >= cols) {
    const float before = col_edges[0] + (turns ? 4.0f : 0.0f) - around;
    const float after = around - col_edges[cols];
    const int first = col < 0 || (turns && before < after);
    const float past = fabs(first ? before : after);
    const float step = first ? col_edges[1] - col_edges[0] : col_edges[cols] - col_edges[cols - 1];
    if (!params->wraps && past > step) return;
    col = first ? 0 : cols - 1;
  }
  node->row = row;
  node->col = col;
}

// Of a column beside the grid: across the seam; -1: there is none.
static inline int column_of(const ClosestSampleParams* params, int col) {
  const int cols = (int)params->cols;
  if (col >= 0 && col < cols) return col;
  if (!params->wraps) return -1;
  return col < 0 ? col + cols : col - cols;
}

#endif
