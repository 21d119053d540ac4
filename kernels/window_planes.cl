// Small windows of samples no supercluster took that lie on a plane: the seeds of small planes (METHOD 3 [+],
// superclusters from leftovers).
// Method: least squares along the rays. In a frame whose axis e0 points at the window, the plane makes the
// inverse depth linear in a = p.e1 / p.e0 and b = p.e2 / p.e0; with weights r^2 the residuals are those of
// the range, to first order. A window is planar when enough of its samples are free, the plane is not seen at
// a grazing angle and chi2 <= f + k sqrt(2 f), f = free samples - 3.
// Mapping: one work-item per VW neighbouring samples of a row, lane = sample, the upper left corner of its
// windows; most end at once. A sample of a window that is not free has weight 0.
// in:  x, y, z [halo_rows * halo_cols], metres, scan frame; free [halo_rows * halo_cols]: 1 = measured and in
//      no supercluster, else any other node, whose coordinates are not looked at.
// out: shape [rows * cols]: 1 + the first planar shape (params_window_planes.h), 0 = none.
// Params: WindowPlanesParams. Defines: VW lanes. Edges: windows that leave the arrays are not tried.
// Cost: 1 byte per sample where nothing is free; per free sample 48 samples of 13 bytes, about 1500 flops.
// Reference twin: tests/reference/window_planes.cpp.
#include "lib/lanes_sym3.h"
#include "lib/range_noise.h"
#include "shared/params_window_planes.h"

#define MOST_SAMPLES 24

// Where the lanes' windows begin, and the end of the arrays.
typedef struct WindowCorners {
  uint first, total;
  LanesVec3 point;
} WindowCorners;

static inline void load_points(global const float* x, global const float* y, global const float* z, uint at,
                               uint total, LanesVec3* points) {
  points->x = load_lanes(x, at, total, 0.0f);
  points->y = load_lanes(y, at, total, 0.0f);
  points->z = load_lanes(z, at, total, 0.0f);
}

// Unit vectors: e0 towards the point, e1 across it along the axis that is least along e0, so that nothing
// cancels, e2 across both.
static inline void frame_towards(LanesVec3 point, floatv depth, LanesVec3* e0, LanesVec3* e1, LanesVec3* e2) {
  e0->x = point.x / depth;
  e0->y = point.y / depth;
  e0->z = point.z / depth;
  const floatv zero = (floatv)(0.0f);
  const intv along_x = MASK((fabs(e0->x) <= fabs(e0->y))) & MASK((fabs(e0->x) <= fabs(e0->z)));
  const intv along_y = MASK((fabs(e0->y) <= fabs(e0->z)));
  e1->x = PICK(along_x, zero, PICK(along_y, -e0->z, e0->y));
  e1->y = PICK(along_x, e0->z, PICK(along_y, zero, -e0->x));
  e1->z = PICK(along_x, -e0->y, PICK(along_y, e0->x, zero));
  const floatv length = sqrt(lanes_dot(*e1, *e1));
  e1->x /= length;
  e1->y /= length;
  e1->z /= length;
  e2->x = e0->y * e1->z - e0->z * e1->y;
  e2->y = e0->z * e1->x - e0->x * e1->z;
  e2->z = e0->x * e1->y - e0->y * e1->x;
}

// Which of the lanes asked have a plane through the free samples of their window. The corner itself is free.
// No restrict here: inlined, it leaves a hint that oclgrind does not know.
static inline intv are_planar(global const float* x, global const float* y, global const float* z,
                              global const uchar* free, const WindowCorners* corners, uint shape,
                              WindowPlanesParams params, intv asked) {
  const uint rows = WINDOW_ROWS(shape), cols = WINDOW_COLS(shape);
  intv use[MOST_SAMPLES];
  floatv count = (floatv)(0.0f);
  uint n = 0u;
  for (uint r = 0u; r < rows; ++r)
    for (uint c = 0u; c < cols; ++c, ++n) {
      use[n] = MASK((load_bytes(free, corners->first + r * params.halo_cols + c, corners->total) == 1));
      count += PICK(use[n], (floatv)(1.0f), (floatv)(0.0f));
    }
  const floatv least = (floatv)(fmax(params.min_share * (float)(rows * cols), 4.0f));
  asked &= MASK((count >= least));
  if (!ANY(asked)) return asked;

  const LanesVec3 first = corners->point;
  const floatv depth = sqrt(lanes_dot(first, first));
  LanesVec3 e0, e1, e2;
  frame_towards(first, depth, &e0, &e1, &e2);

  // h = depth / (p.e0) - 1 keeps the digits that the inverse depth would lose; scale h is the residual in
  // range.
  floatv a[MOST_SAMPLES], b[MOST_SAMPLES], h[MOST_SAMPLES], scale[MOST_SAMPLES];
  floatv total = (floatv)(0.0f), mean_a = total, mean_b = total, mean_h = total;
  n = 0u;
  for (uint r = 0u; r < rows; ++r)
    for (uint c = 0u; c < cols; ++c, ++n) {
      LanesVec3 p;
      load_points(x, y, z, corners->first + r * params.halo_cols + c, corners->total, &p);
      p.x = PICK(use[n], p.x, first.x);
      p.y = PICK(use[n], p.y, first.y);
      p.z = PICK(use[n], p.z, first.z);
      const floatv along = lanes_dot(p, e0);
      a[n] = lanes_dot(p, e1) / along;
      b[n] = lanes_dot(p, e2) / along;
      h[n] = (depth - along) / along;
      scale[n] = PICK(use[n], sqrt(lanes_dot(p, p)) * along / depth, (floatv)(0.0f));
      const floatv w = scale[n] * scale[n];
      total += w;
      mean_a += w * a[n];
      mean_b += w * b[n];
      mean_h += w * h[n];
    }
  mean_a /= total;
  mean_b /= total;
  mean_h /= total;
  floatv aa = (floatv)(0.0f), ab = aa, bb = aa, ah = aa, bh = aa;
  for (uint k = 0u; k < n; ++k) {
    const floatv w = scale[k] * scale[k], da = a[k] - mean_a, db = b[k] - mean_b, dh = h[k] - mean_h;
    aa += w * da * da;
    ab += w * da * db;
    bb += w * db * db;
    ah += w * da * dh;
    bh += w * db * dh;
  }
  const floatv determinant = aa * bb - ab * ab;
  asked &= MASK((determinant > 1e-4f * aa * bb));  // else samples in line
  const floatv slope_a = (bb * ah - ab * bh) / determinant, slope_b = (aa * bh - ab * ah) / determinant;
  const floatv intercept = 1.0f + mean_h - slope_a * mean_a - slope_b * mean_b;
  floatv squares = (floatv)(0.0f);
  for (uint k = 0u; k < n; ++k) {
    const floatv error = scale[k] * (h[k] - mean_h - slope_a * (a[k] - mean_a) - slope_b * (b[k] - mean_b));
    squares += error * error;
  }
  // Incidence at the corner: depth m, with m the normal over the offset, is (intercept, slope_a, slope_b) in
  // the frame's axes.
  const floatv cosine = intercept / sqrt(intercept * intercept + slope_a * slope_a + slope_b * slope_b);
  const floatv sigma = range_noise_m(params.noise, depth, cosine);
  const floatv chi2 = squares / (sigma * sigma), freedom = count - 3.0f;
  return asked & MASK((cosine >= params.min_cosine)) &
         MASK((chi2 <= freedom + params.chi2_sigmas * sqrt(2.0f * freedom)));
}

kernel void window_planes(WindowPlanesParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const uchar* restrict free, global uchar* restrict shape) {
  const uint col = get_global_id(0) * (uint)VW, row = get_global_id(1);
  if (col >= params.cols || row >= params.rows) return;
  WindowCorners corners;
  corners.first = row * params.halo_cols + col;
  corners.total = params.halo_rows * params.halo_cols;
  const intv room = (int)(params.halo_cols - col) - lane_numbers();  // columns from each corner on
  intv open = MASK((load_bytes(free, corners.first, corners.total) == 1)) &
              MASK((lane_numbers() < (intv)((int)(params.cols - col))));
  intv found = (intv)(0);
  if (ANY(open)) {
    load_points(x, y, z, corners.first, corners.total, &corners.point);
    for (uint s = 0u; s < WINDOW_SHAPES && ANY(open); ++s) {
      if (row + WINDOW_ROWS(s) > params.halo_rows) continue;
      const intv planar =
          are_planar(x, y, z, free, &corners, s, params, open & MASK((room >= (intv)((int)WINDOW_COLS(s)))));
      found = PICK(planar, (intv)((int)s + 1), found);
      open &= ~planar;
    }
  }
  int lane[VW];
  STORE_LANES(found, lane);
  for (uint k = 0u; k < VW && col + k < params.cols; ++k) shape[row * params.cols + col + k] = (uchar)lane[k];
}
