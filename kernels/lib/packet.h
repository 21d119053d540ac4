// Packets of VW rays: the pixels they cover.
#ifndef HYBRID_LIB_PACKET_H
#define HYBRID_LIB_PACKET_H
#include "lib/lanes.h"

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
