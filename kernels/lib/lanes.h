// Explicit vectors of VW lanes: lanes_f and lanes_i, the latter also what comparisons give. With VW = 1 they
// are plain float and int, so kernels combine comparisons with & and | and select with ?: , which mean the
// same for both. Every operation acts on each lane alone: the same bits for any VW.
#ifndef HYBRID_LIB_LANES_H
#define HYBRID_LIB_LANES_H
#include "shared/layout.h"

#ifndef VW
#define VW 1
#endif

#if VW == 1
typedef float lanes_f;
typedef int lanes_i;
#define lanes_store(value, target) (*(target) = (value))
#define lanes_load(source) (*(source))
#define lanes_all(condition) (condition)
#else
#define LANES_JOIN_(a, b) a##b
#define LANES_JOIN(a, b) LANES_JOIN_(a, b)
typedef LANES_JOIN(float, VW) lanes_f;
typedef LANES_JOIN(int, VW) lanes_i;
#define lanes_store(value, target) LANES_JOIN(vstore, VW)((value), 0, (target))
#define lanes_load(source) LANES_JOIN(vload, VW)(0, (source))
#define lanes_all(condition) all(condition)
#endif

static inline lanes_f lanes_max(lanes_f a, lanes_f b) {
  return a > b ? a : b;
}

#endif
