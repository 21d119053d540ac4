// Noise along a ray of `range` metres that meets a surface with |normal . ray| = cosine
// (shared/range_noise.h).
#ifndef HYBRID_LIB_RANGE_NOISE_H
#define HYBRID_LIB_RANGE_NOISE_H
#include "shared/range_noise.h"

static inline float range_noise_m(RangeNoiseRecord noise, float range, float cosine) {
  const float tangent =
      fmin(sqrt(fmax(1.0f - cosine * cosine, 0.0f)) / fmax(cosine, 1e-6f), RANGE_NOISE_MOST_TAN);
  return noise.base_m + noise.per_m * range + (noise.per_tan_m + noise.per_m_tan * range) * tangent;
}

#endif
