// A photograph's light at a position, and what is summed of it per surface point.
#ifndef HYBRID_LIB_PHOTO_LIGHT_H
#define HYBRID_LIB_PHOTO_LIGHT_H
#include "shared/params_blend_photos.h"

// The four pixels around a position and their shares; the image goes on beyond its border, and a full
// panorama on its other side.
typedef struct Bilinear {
  uint pixel[4];
  float share[4];
} Bilinear;

// Through a pointer: oclgrind's compiler stumbles over structs returned through two inlined functions.
static inline void bilinear_at(const CameraRecord* camera, float column, float row, Bilinear* at) {
  const uint wraps = camera->flags & CAMERA_WRAPS;
  float x = column - 0.5f;
  if (wraps && x < 0.0f) x += (float)camera->width;
  // A full turn reaches up to the width, beyond the last pixel's centre.
  x = clamp(x, 0.0f, wraps ? nextafter((float)camera->width, 0.0f) : (float)(camera->width - 1u));
  const float y = clamp(row - 0.5f, 0.0f, (float)(camera->height - 1u));
  const uint x0 = (uint)x, y0 = (uint)y;
  const uint x1 = x0 + 1u < camera->width ? x0 + 1u : wraps ? 0u : x0;
  const uint y1 = min(y0 + 1u, camera->height - 1u);
  const float right = x - (float)x0, below = y - (float)y0;
  at->pixel[0] = y0 * camera->width + x0;
  at->pixel[1] = y0 * camera->width + x1;
  at->pixel[2] = y1 * camera->width + x0;
  at->pixel[3] = y1 * camera->width + x1;
  at->share[0] = (1.0f - right) * (1.0f - below);
  at->share[1] = right * (1.0f - below);
  at->share[2] = (1.0f - right) * below;
  at->share[3] = right * below;
}

// Is the position one of the photograph's own, none of whose pixels the mask takes out?
static inline int is_photograph(const CameraRecord* camera, const Bilinear* at, global const uchar* photo) {
  if (!(camera->flags & CAMERA_HAS_MASK)) return 1;
  int whole = 1;
  for (int k = 0; k < 4; ++k) whole &= at->share[k] == 0.0f || photo[4u * at->pixel[k] + 3u] != 0;
  return whole;
}

static inline float3 light_at(const Bilinear* at, global const uchar* photo, global const float* linear) {
  float3 light = (float3)(0.0f);
  for (int k = 0; k < 4; ++k) {
    const uchar4 bytes = vload4(at->pixel[k], photo);
    light += at->share[k] * (float3)(linear[bytes.x], linear[256u + bytes.y], linear[512u + bytes.z]);
  }
  return light;
}

static inline float3 low_at(const Bilinear* at, global const half* low) {
  float3 light = (float3)(0.0f);
  for (int k = 0; k < 4; ++k) light += at->share[k] * vload_half4(at->pixel[k], low).xyz;
  return light;
}

// x^n, 0 <= x <= 1, by squaring: the same bits everywhere.
static inline float whole_power(float x, uint n) {
  float power = 1.0f;
  for (; n != 0u; n >>= 1) {
    if (n & 1u) power *= x;
    x *= x;
  }
  return power;
}

// Adds a band to those of heavier and lighter photographs, each by (weight / heaviest)^power: the heaviest
// rules, and hands over without a seam where another one becomes it. The sums are relative to the heaviest so
// far, so that no power leaves the range of floats. `at`: the band's red of the point.
static inline void add_band(float3 band, float weight, float heaviest, uint power, uint count,
                            global float* at) {
  const float kept = weight > heaviest ? whole_power(heaviest / weight, power) : 1.0f;
  const float added = weight > heaviest ? 1.0f : whole_power(weight / heaviest, power);
  at[0] = kept * at[0] + added * band.x;
  at[count] = kept * at[count] + added * band.y;
  at[2u * count] = kept * at[2u * count] + added * band.z;
  at[3u * count] = kept * at[3u * count] + added;
}

// Splits the light into bands, adds all but the lowest, and returns that. `low` holds an image per Gaussian,
// the narrowest first: what a Gaussian takes away is a band (Burt and Adelson 1983).
static inline float3 add_bands(const Bilinear* around, BlendMode mix, uint photo_pixels, float3 light,
                               float weight, global const half* low, uint count, uint i, global float* sums) {
  const float heaviest = sums[BLEND_BEST_WEIGHT * count + i];
  for (uint band = 0u; band + 1u < mix.bands; ++band) {
    const float3 smooth = low_at(around, low + (size_t)4 * band * photo_pixels);
    const uint plane = band == 0u ? BLEND_BEST_R : BLEND_PLANES + BLEND_BAND_PLANES * (band - 1u);
    add_band(light - smooth, weight, heaviest, mix.power[band], count, sums + (size_t)plane * count + i);
    light = smooth;
  }
  return light;
}

// Adds the light that photograph number `photograph`, of `photo_pixels` pixels, has at a position to point i
// of `count`.
static inline void add_light(const Bilinear* around, BlendMode mix, int photograph, uint photo_pixels,
                             float weight, global const uchar* photo, global const half* low,
                             global const float* linear, uint count, uint i, global float* sums,
                             global int* best) {
  const float3 light = light_at(around, photo, linear);
  const float3 smooth = mix.mode == BLEND_BANDS
                            ? add_bands(around, mix, photo_pixels, light, weight, low, count, i, sums)
                            : light;
  sums[BLEND_SUM_R * count + i] += weight * smooth.x;
  sums[BLEND_SUM_G * count + i] += weight * smooth.y;
  sums[BLEND_SUM_B * count + i] += weight * smooth.z;
  sums[BLEND_SUM_WEIGHT * count + i] += weight;
  if (!(weight > sums[BLEND_BEST_WEIGHT * count + i])) return;
  if (mix.mode != BLEND_BANDS) {
    sums[BLEND_BEST_R * count + i] = light.x;
    sums[BLEND_BEST_G * count + i] = light.y;
    sums[BLEND_BEST_B * count + i] = light.z;
    sums[BLEND_BEST_SHARE * count + i] = 1.0f;
  }
  sums[BLEND_BEST_WEIGHT * count + i] = weight;
  best[i] = photograph;
}

#endif
