// Noise along a ray of `range` metres that meets a surface with |normal . ray| = cosine
// (shared/range_noise.h).
#ifndef HYBRID_LIB_RANGE_NOISE_H
#define HYBRID_LIB_RANGE_NOISE_H
#include "lib/lanes.h"
#include "shared/range_noise.h"

static inline floatv range_noise_m(RangeNoiseRecord noise, floatv range, floatv cosine) {
  const floatv tangent =
      fmin(sqrt(fmax(1.0f - cosine * cosine, 0.0f)) / fmax(cosine, 1e-6f), RANGE_NOISE_MOST_TAN);
  return noise.base_m + noise.per_m * range + (noise.per_tan_m + noise.per_m_tan * range) * tangent;
}

#endif
