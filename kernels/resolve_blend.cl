// Colours from what blend_photos summed over all photographs (METHOD 10): the weighted mean (linear), the
// heaviest photograph (nearest), or the mean of the lowest bands plus that of each higher one, in which the
// heaviest rules the more the higher it is (bands). Seen by no photograph = red (1,0,0), the paper's
// figure 6.
//
// Mapping: one work-item per point.
//
// in: sums[planes * count] (shared/params_blend_photos.h), seen[count]; surface_x[count]: NaN = no
// surface.
//
// out: colour[3 * count], linear light, interleaved; NaN where there is no surface. Bands are clamped at 0.
//
// Cost: 44 bytes read (16 more per band beyond two), 12 written, 10 flops per point. Reference twin:
// tests/reference/resolve_blend.cpp.
#include "shared/params_blend_photos.h"

kernel void resolve_blend(const ResolveBlendParams params, global const float* restrict surface_x,
                          global const float* restrict sums, global const uint* restrict seen,
                          global float* restrict colour) {
  const uint i = get_global_id(0);
  if (i >= params.count) return;
  const uint count = params.count;
  const float3 mean =
      (float3)(sums[BLEND_SUM_R * count + i], sums[BLEND_SUM_G * count + i], sums[BLEND_SUM_B * count + i]) /
      sums[BLEND_SUM_WEIGHT * count + i];
  const float3 best = (float3)(sums[BLEND_BEST_R * count + i], sums[BLEND_BEST_G * count + i],
                               sums[BLEND_BEST_B * count + i]) /
                      sums[BLEND_BEST_SHARE * count + i];
  float3 bands = mean + best;
  for (uint band = 1u; params.mode == BLEND_BANDS && band + 1u < params.bands; ++band) {
    global const float* at = sums + (size_t)(BLEND_PLANES + BLEND_BAND_PLANES * (band - 1u)) * count + i;
    bands += (float3)(at[0], at[count], at[2u * count]) / at[3u * count];
  }
  float3 result = (float3)(1.0f, 0.0f, 0.0f);
  if (isnan(surface_x[i]))
    result = (float3)(NAN);
  else if (seen[i] != 0u)
    result = params.mode == BLEND_NEAREST  ? best
             : params.mode == BLEND_LINEAR ? mean
                                           : max(bands, (float3)(0.0f));
  vstore3(result, i, colour);
}
