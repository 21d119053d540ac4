// Known answers for `hybrid devices`: integer mixing, IEEE division and square root, NaN comparisons.
// Mapping: one work-item per element.
// out: bits[count] = random_bits(seed, i, 1); values[count] = sqrt(i + 1) / (1 + i mod 7), NaN where i mod 11
// = 10. Cost: 8 bytes written, about 20 operations per item. Reference twin: tests/reference/self_test.cpp.
#include "lib/random.h"

kernel void self_test(uint seed, uint count, global uint* restrict bits, global float* restrict values) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  bits[i] = random_bits(seed, i, 1u);
  const float value = sqrt((float)(i + 1u)) / (1.0f + (float)(i % 7u));
  values[i] = i % 11u == 10u ? NAN : value;
}
