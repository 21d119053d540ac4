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

// PORTABLE: nothing but OpenCL C, for devices that are no CPU and for interpreters (tests/oclgrind.sh).
#if defined(__has_builtin) && !defined(PORTABLE)
#if __has_builtin(__builtin_reduce_or) && __has_builtin(__builtin_reduce_and)
#define REDUCE_BITS(value) __builtin_reduce_or(value)
#endif
#endif

// Asks for the cache line of what is read soon.
#define FETCH(at)
#if defined(__has_builtin) && !defined(PORTABLE)
#if __has_builtin(__builtin_prefetch)
#undef FETCH
#define FETCH(at) __builtin_prefetch(at)
#endif
#endif

#if VW == 1
typedef float floatv;
typedef int intv;
typedef uint uintv;
#define MASK(condition) (-(int)(condition))
#define ANY(mask) ((mask) != 0)
#define ALL(mask) ((mask) != 0)
#define PICK(mask, yes, no) ((mask) ? (yes) : (no))
#define BITS_OF_LANES(value) as_uint(value)
#define LOAD_LANES(from) ((from)[0])
#define STORE_LANES(value, to) ((to)[0] = (value))
#else
#define LANES_JOIN_(a, b) a##b
#define LANES_JOIN(a, b) LANES_JOIN_(a, b)
typedef LANES_JOIN(float, VW) floatv;
typedef LANES_JOIN(int, VW) intv;
typedef LANES_JOIN(uint, VW) uintv;
#define MASK(condition) (condition)
// PoCL's any() and all() look at the lanes one by one (8 branches for 16); reductions are one test of a mask
// register.
#ifdef REDUCE_BITS
#define ANY(mask) (REDUCE_BITS(mask) != 0)
#define ALL(mask) (__builtin_reduce_and(mask) != 0)
#else
#define ANY(mask) any(mask)
#define ALL(mask) all(mask)
#endif
#define PICK(mask, yes, no) select(no, yes, mask)
#define BITS_OF_LANES(value) LANES_JOIN(as_uint, VW)(value)
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

// The same of bytes; lanes at or beyond `count` get 0.
static inline intv load_bytes(global const uchar* bytes, uint first, uint count) {
#if VW > 1
  if (first + VW <= count) return LANES_JOIN(convert_int, VW)(LANES_JOIN(vload, VW)(0, bytes + first));
#endif
  int lane[VW];
  for (uint k = 0; k < VW; ++k) lane[k] = first + k < count ? bytes[first + k] : 0;
  return LOAD_LANES(lane);
}

// Each lane's own number.
static inline intv lane_numbers(void) {
  int lane[VW];
  for (uint k = 0; k < VW; ++k) lane[k] = (int)k;
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

// One bit per lane of a mask of 8 or 16, the first lane's the lowest.
static inline uint bits_of_8(int8 mask) {
#if defined(__AVX512DQ__) && defined(__AVX512VL__) && !defined(PORTABLE)
  return (uchar)__builtin_ia32_cvtd2mask256(mask);
#else
  const int8 bits = mask & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
#ifdef REDUCE_BITS
  return (uint)REDUCE_BITS(bits);
#else
  const int4 by4 = bits.lo | bits.hi;
  const int2 by2 = by4.lo | by4.hi;
  return (uint)(by2.x | by2.y);
#endif
#endif
}
static inline uint bits_of(int16 mask) {
#if defined(__AVX512DQ__) && !defined(PORTABLE)
  return (ushort)__builtin_ia32_cvtd2mask512(mask);
#else
  return bits_of_8(mask.lo) | bits_of_8(mask.hi) << 8;
#endif
}

// Which is the lowest bit set; there is one.
static inline uint lowest_bit(uint bits) {
  return 31u - clz(bits & (0u - bits));
}

// values[at] for every lane.
static inline floatv lanes_at(global const float* values, uintv at) {
#if VW == 16 && defined(__AVX512F__) && !defined(PORTABLE)
  return __builtin_ia32_gathersiv16sf((float16)(0.0f), values, as_int16(at), (ushort)0xffff, 4);
#else
  uint index[VW];
  float lane[VW];
  STORE_LANES(at, index);
  for (uint k = 0; k < VW; ++k) lane[k] = values[index[k]];
  return LOAD_LANES(lane);
#endif
}
static inline uintv words_at(global const uint* values, uintv at) {
#if VW == 1
  return values[at];
#else
  return BITS_OF_LANES(lanes_at((global const float*)values, at));
#endif
}

#if VW == 16 && defined(__AVX512F__) && !defined(PORTABLE)
// entries[at % 32], and on to 128 by halves.
static inline float16 entries_of_32(global const float* entries, int16 at) {
  return __builtin_ia32_vpermi2varps512(vload16(0, entries), at, vload16(1, entries));
}
static inline float16 entries_of_64(global const float* entries, int16 at) {
  return (at & 32) != 0 ? entries_of_32(entries + 32, at) : entries_of_32(entries, at);
}
static inline float16 entries_of_128(global const float* entries, int16 at) {
  return (at & 64) != 0 ? entries_of_64(entries + 64, at) : entries_of_64(entries, at);
}
#endif

// entries[at] for every lane, of 256 entries. A table this small fits in registers, where 8 permutations
// and 7 choices take two thirds of the time of a gather.
__attribute__((always_inline)) static inline floatv entries_at(global const float* entries, uintv at) {
#if VW == 16 && defined(__AVX512F__) && !defined(PORTABLE)
  const int16 index = as_int16(at);
  return (index & 128) != 0 ? entries_of_128(entries + 128, index) : entries_of_128(entries, index);
#else
  return lanes_at(entries, at);
#endif
}

// The two words from words[at] on, for every lane.
typedef struct LanePairs {
  uintv first, second;
} LanePairs;
static inline LanePairs pairs_at(global const uint* words, uintv at) {
  LanePairs out;
#if VW == 16 && defined(__AVX512F__) && !defined(PORTABLE)
  const int16 index = as_int16(at);
  const uint16 low = as_uint16(__builtin_ia32_gathersiv8di((long8)(0), words, index.lo, (uchar)0xff, 4));
  const uint16 high = as_uint16(__builtin_ia32_gathersiv8di((long8)(0), words, index.hi, (uchar)0xff, 4));
  out.first = (uint16)(low.even, high.even);
  out.second = (uint16)(low.odd, high.odd);
#else
  out.first = words_at(words, at);
  out.second = words_at(words, at + 1u);
#endif
  return out;
}

// The records of four words that begin at 4 * at, for every lane.
typedef struct LaneRecords {
  floatv x, y, z, w;
} LaneRecords;
static inline LaneRecords records_at(global const float* records, uintv at) {
  LaneRecords out;
#if VW == 16 && defined(__AVX512F__) && !defined(PORTABLE)
  out.x = lanes_at(records, 4u * at);
  out.y = lanes_at(records, 4u * at + 1u);
  out.z = lanes_at(records, 4u * at + 2u);
  out.w = lanes_at(records, 4u * at + 3u);
#else
  uint index[VW];
  float x[VW], y[VW], z[VW], w[VW];
  STORE_LANES(at, index);
  for (uint k = 0; k < VW; ++k) {
    const float4 record = vload4(index[k], records);
    x[k] = record.x, y[k] = record.y, z[k] = record.z, w[k] = record.w;
  }
  out.x = LOAD_LANES(x), out.y = LOAD_LANES(y), out.z = LOAD_LANES(z), out.w = LOAD_LANES(w);
#endif
  return out;
}

// The floats of halves, the lower 16 bits of each lane. PoCL's vload_half converts them by integer
// arithmetic.
static inline floatv halves_of(uintv bits) {
#if VW == 16 && defined(__AVX512F__) && !defined(PORTABLE)
  typedef short halves __attribute__((ext_vector_type(16)));
  return __builtin_ia32_vcvtph2ps512_mask(__builtin_convertvector(bits, halves), (float16)(0.0f),
                                          (ushort)0xffff, 4);
#else
  ushort lane[VW];
#if VW == 1
  lane[0] = (ushort)bits;
  return vload_half(0, (const half*)lane);
#else
  STORE_LANES(LANES_JOIN(convert_ushort, VW)(bits & 0xffffu), lane);
  return LANES_JOIN(vload_half, VW)(0, (const half*)lane);
#endif
#endif
}

// Towards 0, of what fits an int.
static inline uintv whole_of(floatv value) {
#if VW == 1
  return (uint)(int)value;
#else
  return LANES_JOIN(as_uint, VW)(LANES_JOIN(convert_int, VW)(value));
#endif
}

// Smallest and largest lane.
#define DEFINE_FOLD(name, fold)                  \
  static inline float name##_2(float2 value) {   \
    return fold(value.x, value.y);               \
  }                                              \
  static inline float name##_4(float4 value) {   \
    return name##_2(fold(value.lo, value.hi));   \
  }                                              \
  static inline float name##_8(float8 value) {   \
    return name##_4(fold(value.lo, value.hi));   \
  }                                              \
  static inline float name##_16(float16 value) { \
    return name##_8(fold(value.lo, value.hi));   \
  }                                              \
  static inline float name##_1(float value) {    \
    return value;                                \
  }
DEFINE_FOLD(least_of, min)
DEFINE_FOLD(most_of, max)
#define LANES_NAME_(name, width) name##_##width
#define LANES_NAME(name, width) LANES_NAME_(name, width)
#define LEAST_LANE(value) LANES_NAME(least_of, VW)(value)
#define MOST_LANE(value) LANES_NAME(most_of, VW)(value)

// Sum over the lanes, first to last.
static inline float sum_lanes(floatv value) {
  float lane[VW];
  STORE_LANES(value, lane);
  float sum = 0.0f;
  for (uint k = 0; k < VW; ++k) sum += lane[k];
  return sum;
}

#endif
