// Explicit vectors of VW floats, one query or sample per lane; VW = 1 is plain scalar code for a GPU. Masks
// are what comparisons return, so that NaN compares false; combine them with & | and negate with !.
#ifndef HYBRID_LIB_QUERY_LANES_H
#define HYBRID_LIB_QUERY_LANES_H
#include "shared/layout.h"
#ifndef VW
#define VW 1
#endif

#if VW == 1
typedef float Lanes;
typedef int Mask;
typedef uint Indices;
#define VECTOR_LOAD(pointer) (*(pointer))
#define VECTOR_STORE(value, pointer) (*(pointer) = (value))
#define ANY_LANE(mask) ((mask) != 0)
#define AS_INDICES(value) ((uint)(value))
#else
#define LANES_PASTE(a, b) a##b
#define LANES_NAME(a, b) LANES_PASTE(a, b)
typedef LANES_NAME(float, VW) Lanes;
typedef LANES_NAME(int, VW) Mask;
typedef LANES_NAME(uint, VW) Indices;
#define VECTOR_LOAD(pointer) LANES_NAME(vload, VW)(0, pointer)
#define VECTOR_STORE(value, pointer) LANES_NAME(vstore, VW)(value, 0, pointer)
#define ANY_LANE(mask) any(mask)
#define AS_INDICES(value) ((Indices)(value))
#endif

// VW values from `first` on; lanes at or beyond `count` get `fill`.
static inline Lanes load_lanes(global const float* values, uint first, uint count, float fill) {
  if (first + VW <= count) return VECTOR_LOAD(values + first);
  float lane[VW];
  for (uint k = 0; k < VW; ++k) lane[k] = first + k < count ? values[first + k] : fill;
  return VECTOR_LOAD(lane);
}

static inline void store_lanes(Lanes value, global float* values, uint first, uint count) {
  if (first + VW <= count) {
    VECTOR_STORE(value, values + first);
    return;
  }
  float lane[VW];
  VECTOR_STORE(value, lane);
  for (uint k = 0; first + k < count; ++k) values[first + k] = lane[k];
}

static inline void store_indices(Indices value, global uint* values, uint first, uint count) {
  if (first + VW <= count) {
    VECTOR_STORE(value, values + first);
    return;
  }
  uint lane[VW];
  VECTOR_STORE(value, lane);
  for (uint k = 0; first + k < count; ++k) values[first + k] = lane[k];
}

// Sum over the lanes, first to last.
static inline float sum_lanes(Lanes value) {
  float lane[VW];
  VECTOR_STORE(value, lane);
  float sum = 0.0f;
  for (uint k = 0; k < VW; ++k) sum += lane[k];
  return sum;
}

#endif
