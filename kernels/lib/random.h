// Counter-based random numbers: the same (seed, item, draw) gives the same number on every device, for any
// work-group size and tile. Mixing: two rounds of the murmur3 finaliser, which passes the avalanche tests for
// 32-bit counters.
#ifndef HYBRID_LIB_RANDOM_H
#define HYBRID_LIB_RANDOM_H
#include "shared/layout.h"

static inline HYBRID_UINT mix_bits(HYBRID_UINT h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  h ^= h >> 16;
  return h;
}

static inline HYBRID_UINT random_bits(HYBRID_UINT seed, HYBRID_UINT item, HYBRID_UINT draw) {
  return mix_bits(mix_bits(seed + 0x9e3779b9u * item) ^ (0x7f4a7c15u + draw * 0x6c078965u));
}

// Uniform in [0, count).
static inline HYBRID_UINT random_below(HYBRID_UINT seed, HYBRID_UINT item, HYBRID_UINT draw,
                                       HYBRID_UINT count) {
  return random_bits(seed, item, draw) % count;
}

#endif
