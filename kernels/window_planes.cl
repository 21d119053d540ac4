// Small windows of samples no supercluster took that lie on a plane: the seeds of small planes (METHOD 3 [+],
// superclusters from leftovers).
// Method: least squares along the rays. In a frame whose axis e0 points at the window, the plane makes the
// inverse depth linear in a = p.e1 / p.e0 and b = p.e2 / p.e0; with weights r^2 the residuals are those of
// the range, to first order. A window is planar when enough of its samples are free, the plane is not seen at
// a grazing angle and chi2 <= f + k sqrt(2 f), f = free samples - 3.
// Mapping: one work-item per sample of the tile, the upper left corner of its windows; most end at once.
// in:  x, y, z [halo_rows * halo_cols], metres, scan frame; free [halo_rows * halo_cols]: 1 = measured and in
//      no supercluster, else any other node, whose coordinates are not looked at.
// out: shape [rows * cols]: 1 + the first planar shape (params_window_planes.h), 0 = none.
// Params: WindowPlanesParams. Edges: windows that leave the arrays are not tried.
// Cost: 1 byte per sample where nothing is free; per free sample 48 samples of 13 bytes, about 1500 flops.
// Reference twin: tests/reference/window_planes.cpp.
#include "lib/range_noise.h"
#include "shared/params_window_planes.h"

#define MOST_SAMPLES 24

// A plane through the free samples of one window.
// No restrict here: inlined, it leaves a hint that oclgrind does not know.
static inline int is_planar(global const float* x, global const float* y, global const float* z,
                            global const uchar* free, uint corner, uint shape, WindowPlanesParams params) {
  const uint rows = WINDOW_ROWS(shape), cols = WINDOW_COLS(shape);
  uint at[MOST_SAMPLES], count = 0u;
  for (uint r = 0u; r < rows; ++r)
    for (uint c = 0u; c < cols; ++c) {
      const uint i = corner + r * params.halo_cols + c;
      if (free[i] == 1) at[count++] = i;
    }
  if ((float)count < params.min_share * (float)(rows * cols) || count < 4u) return 0;

  const float3 first = (float3)(x[at[0]], y[at[0]], z[at[0]]);
  const float depth = sqrt(dot(first, first));
  const float3 e0 = first / depth;
  // The axis least along e0 gives a perpendicular without cancellation.
  const float3 size = fabs(e0);
  const float3 axis = size.x <= size.y && size.x <= size.z ? (float3)(1.0f, 0.0f, 0.0f)
                      : size.y <= size.z                   ? (float3)(0.0f, 1.0f, 0.0f)
                                                           : (float3)(0.0f, 0.0f, 1.0f);
  const float3 across = cross(e0, axis);
  const float3 e1 = across / sqrt(dot(across, across)), e2 = cross(e0, e1);

  // h = depth / (p.e0) - 1 keeps the digits that the inverse depth would lose; scale h is the residual in
  // range.
  float a[MOST_SAMPLES], b[MOST_SAMPLES], h[MOST_SAMPLES], scale[MOST_SAMPLES];
  float total = 0.0f, mean_a = 0.0f, mean_b = 0.0f, mean_h = 0.0f;
  for (uint k = 0u; k < count; ++k) {
    const float3 p = (float3)(x[at[k]], y[at[k]], z[at[k]]);
    const float along = dot(p, e0);
    a[k] = dot(p, e1) / along;
    b[k] = dot(p, e2) / along;
    h[k] = (depth - along) / along;
    scale[k] = sqrt(dot(p, p)) * along / depth;
    const float w = scale[k] * scale[k];
    total += w;
    mean_a += w * a[k];
    mean_b += w * b[k];
    mean_h += w * h[k];
  }
  mean_a /= total;
  mean_b /= total;
  mean_h /= total;
  float aa = 0.0f, ab = 0.0f, bb = 0.0f, ah = 0.0f, bh = 0.0f;
  for (uint k = 0u; k < count; ++k) {
    const float w = scale[k] * scale[k], da = a[k] - mean_a, db = b[k] - mean_b, dh = h[k] - mean_h;
    aa += w * da * da;
    ab += w * da * db;
    bb += w * db * db;
    ah += w * da * dh;
    bh += w * db * dh;
  }
  const float determinant = aa * bb - ab * ab;
  if (!(determinant > 1e-4f * aa * bb)) return 0;  // samples in line
  const float slope_a = (bb * ah - ab * bh) / determinant, slope_b = (aa * bh - ab * ah) / determinant;
  const float intercept = 1.0f + mean_h - slope_a * mean_a - slope_b * mean_b;
  float squares = 0.0f;
  for (uint k = 0u; k < count; ++k) {
    const float error = scale[k] * (h[k] - mean_h - slope_a * (a[k] - mean_a) - slope_b * (b[k] - mean_b));
    squares += error * error;
  }
  // Incidence at the corner: depth m, with m the normal over the offset, is (intercept, slope_a, slope_b) in
  // the frame's axes.
  const float cosine = intercept / sqrt(intercept * intercept + slope_a * slope_a + slope_b * slope_b);
  const float sigma = range_noise_m(params.noise, depth, cosine);
  const float chi2 = squares / (sigma * sigma), freedom = (float)count - 3.0f;
  return cosine >= params.min_cosine && chi2 <= freedom + params.chi2_sigmas * sqrt(2.0f * freedom);
}

kernel void window_planes(WindowPlanesParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const uchar* restrict free, global uchar* restrict shape) {
  const uint col = get_global_id(0), row = get_global_id(1);
  if (col >= params.cols || row >= params.rows) return;
  const uint corner = row * params.halo_cols + col;
  uint found = 0u;
  if (free[corner] == 1)
    for (uint s = 0u; s < WINDOW_SHAPES && found == 0u; ++s)
      if (row + WINDOW_ROWS(s) <= params.halo_rows && col + WINDOW_COLS(s) <= params.halo_cols &&
          is_planar(x, y, z, free, corner, s, params))
        found = s + 1u;
  shape[row * params.cols + col] = (uchar)found;
}
