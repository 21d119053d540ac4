#ifndef HYBRID_SHARED_RANGE_NOISE_H
#define HYBRID_SHARED_RANGE_NOISE_H
#include "shared/layout.h"

// Standard deviation of the noise along a ray, metres: base + per_m r + (per_tan + per_m_tan r)
// tan(incidence), the tangent counted up to RANGE_NOISE_MOST_TAN. A beam that meets a surface at an angle
// spreads in depth by its width times the tangent.
#define RANGE_NOISE_MOST_TAN 20.0f

typedef struct RangeNoiseRecord {
  float base_m, per_m, per_tan_m, per_m_tan;
} RangeNoiseRecord;
LAYOUT_CHECK(RangeNoiseRecord, 16);

#endif
