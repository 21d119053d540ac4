// Explicit vectors of VW lanes, one source for every width: on PoCL a vector of 16 is several times faster
// than 16 work-items, on a GPU VW is 1. Masks are what vector comparisons return, -1 (true) or 0 per lane;
// MASK() makes scalar comparisons say the same. NaN compares false. Every operation acts on each lane alone:
// the same bits for any VW.
#ifndef HYBRID_LIB_LANES_H
#define HYBRID_LIB_LANES_H
#include "shared/layout.h"

#ifndef VW
#define VW 1
#endif

#if VW == 1
typedef float floatv;
typedef int intv;
typedef uint uintv;
#define MASK(condition) (-(int)(condition))
#define ANY(mask) ((mask) != 0)
#define ALL(mask) ((mask) != 0)
#define PICK(mask, yes, no) ((mask) ? (yes) : (no))
#define LOAD_LANES(from) ((from)[0])
#define STORE_LANES(value, to) ((to)[0] = (value))
#else
#define LANES_JOIN_(a, b) a##b
#define LANES_JOIN(a, b) LANES_JOIN_(a, b)
typedef LANES_JOIN(float, VW) floatv;
typedef LANES_JOIN(int, VW) intv;
typedef LANES_JOIN(uint, VW) uintv;
#define MASK(condition) (condition)
#define ANY(mask) any(mask)
#define ALL(mask) all(mask)
#define PICK(mask, yes, no) select(no, yes, mask)
#define LOAD_LANES(from) LANES_JOIN(vload, VW)(0, from)
#define STORE_LANES(value, to) LANES_JOIN(vstore, VW)(value, 0, to)
#endif

// NaN in a gives b, at every width.
static inline floatv lanes_max(floatv a, floatv b) {
  return a > b ? a : b;
}

// VW values from `first` on; lanes at or beyond `count` get `fill`.
static inline floatv load_lanes(global const float* values, uint first, uint count, float fill) {
  if (first + VW <= count) return LOAD_LANES(values + first);
  float lane[VW];
  for (uint k = 0; k < VW; ++k) lane[k] = first + k < count ? values[first + k] : fill;
  return LOAD_LANES(lane);
}

// Their counterparts, which leave what lies at or beyond `count` alone.
#define DEFINE_STORE(name, vector, scalar)                                               \
  static inline void name(vector value, global scalar* values, uint first, uint count) { \
    scalar lane[VW];                                                                     \
    if (first + VW <= count) {                                                           \
      STORE_LANES(value, values + first);                                                \
    } else {                                                                             \
      STORE_LANES(value, lane);                                                          \
      for (uint k = 0; first + k < count; ++k) values[first + k] = lane[k];              \
    }                                                                                    \
  }
DEFINE_STORE(store_lanes, floatv, float)
DEFINE_STORE(store_indices, uintv, uint)

// Sum over the lanes, first to last.
static inline float sum_lanes(floatv value) {
  float lane[VW];
  STORE_LANES(value, lane);
  float sum = 0.0f;
  for (uint k = 0; k < VW; ++k) sum += lane[k];
  return sum;
}

#endif
