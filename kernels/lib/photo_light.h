// A photograph's light at a position, and what is summed of it per surface point.
#ifndef HYBRID_LIB_PHOTO_LIGHT_H
#define HYBRID_LIB_PHOTO_LIGHT_H
#include "shared/params_blend_photos.h"

// The four pixels around a position and their shares; the image goes on beyond its border.
typedef struct Bilinear {
  uint pixel[4];
  float share[4];
} Bilinear;

static inline Bilinear bilinear_at(const CameraRecord* camera, float column, float row) {
  const float x = clamp(column - 0.5f, 0.0f, (float)(camera->width - 1u));
  const float y = clamp(row - 0.5f, 0.0f, (float)(camera->height - 1u));
  const uint x0 = (uint)x, y0 = (uint)y;
  const uint x1 = min(x0 + 1u, camera->width - 1u), y1 = min(y0 + 1u, camera->height - 1u);
  const float right = x - (float)x0, below = y - (float)y0;
  Bilinear at = {
      {y0 * camera->width + x0, y0 * camera->width + x1, y1 * camera->width + x0, y1 * camera->width + x1},
      {(1.0f - right) * (1.0f - below), right * (1.0f - below), (1.0f - right) * below, right * below}};
  return at;
}

static inline float3 light_at(const Bilinear* at, global const uchar* photo, global const float* linear) {
  float3 light = (float3)(0.0f);
  for (int k = 0; k < 4; ++k) {
    const uchar4 bytes = vload4(at->pixel[k], photo);
    light += at->share[k] * (float3)(linear[bytes.x], linear[bytes.y], linear[bytes.z]);
  }
  return light;
}

static inline float3 low_at(const Bilinear* at, global const half* low) {
  float3 light = (float3)(0.0f);
  for (int k = 0; k < 4; ++k) light += at->share[k] * vload_half4(at->pixel[k], low).xyz;
  return light;
}

// Adds the light that photograph number `photograph` has at a position to point i of `count`.
static inline void add_light(const CameraRecord* camera, uint mode, int photograph, float column, float row,
                             float weight, global const uchar* photo, global const half* low,
                             global const float* linear, uint count, uint i, global float* sums,
                             global int* best) {
  const Bilinear around = bilinear_at(camera, column, row);
  const float3 light = light_at(&around, photo, linear);
  const float3 smooth = mode == BLEND_DUAL ? low_at(&around, low) : light;
  sums[BLEND_SUM_R * count + i] += weight * smooth.x;
  sums[BLEND_SUM_G * count + i] += weight * smooth.y;
  sums[BLEND_SUM_B * count + i] += weight * smooth.z;
  sums[BLEND_SUM_WEIGHT * count + i] += weight;
  if (weight > sums[BLEND_BEST_WEIGHT * count + i]) {
    const float3 kept = mode == BLEND_DUAL ? light - smooth : light;
    sums[BLEND_BEST_R * count + i] = kept.x;
    sums[BLEND_BEST_G * count + i] = kept.y;
    sums[BLEND_BEST_B * count + i] = kept.z;
    sums[BLEND_BEST_WEIGHT * count + i] = weight;
    best[i] = photograph;
  }
}

#endif
