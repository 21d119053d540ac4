// Explicit vectors of VW lanes, one source for every width: on PoCL a packet of 16 rays is several times
// faster than 16 work-items, on a GPU VW is 1. Masks are -1 (true) or 0 per lane at every width.
#ifndef HYBRID_LIB_PACKET_H
#define HYBRID_LIB_PACKET_H
#include "shared/layout.h"

#ifndef VW
#define VW 1
#endif

// Shape of a packet in pixels, as square as VW allows: neighbouring rays visit the same nodes.
#if VW == 16
#define PACKET_COLS 4u
#define PACKET_ROWS 4u
#elif VW == 8
#define PACKET_COLS 4u
#define PACKET_ROWS 2u
#elif VW == 4
#define PACKET_COLS 2u
#define PACKET_ROWS 2u
#else
#define PACKET_COLS 1u
#define PACKET_ROWS 1u
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
#define PACKET_JOIN_(a, b) a##b
#define PACKET_JOIN(a, b) PACKET_JOIN_(a, b)
typedef PACKET_JOIN(float, VW) floatv;
typedef PACKET_JOIN(int, VW) intv;
typedef PACKET_JOIN(uint, VW) uintv;
#define MASK(condition) (condition)
#define ANY(mask) any(mask)
#define ALL(mask) all(mask)
#define PICK(mask, yes, no) select(no, yes, mask)
#define LOAD_LANES(from) PACKET_JOIN(vload, VW)(0, from)
#define STORE_LANES(value, to) PACKET_JOIN(vstore, VW)(value, 0, to)
#endif

// Packets that cover an image of cols x rows. An image of one row (a list of rays) is cut into runs of VW.
static inline uint packet_cols(uint rows) {
  return rows == 1u ? (uint)VW : PACKET_COLS;
}

// Pixel of a lane of packet (x, y). The host launches ceil(cols / packet columns) x ceil(rows / packet rows).
static inline uint2 packet_pixel(uint x, uint y, uint lane, uint rows) {
  if (rows == 1u) return (uint2)(x * (uint)VW + lane, y);
  return (uint2)(x * PACKET_COLS + lane % PACKET_COLS, y * PACKET_ROWS + lane / PACKET_COLS);
}

#endif
