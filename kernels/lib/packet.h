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

// Columns and rows of the lanes' pixels, from the packet's corner on.
static inline void packet_steps(uint rows, float* column, float* row) {
  for (uint lane = 0u; lane < VW; ++lane) {
    column[lane] = (float)(rows == 1u ? lane : lane % PACKET_COLS);
    row[lane] = (float)(rows == 1u ? 0u : lane / PACKET_COLS);
  }
}

// Writes a packet's lanes to an image of cols x rows, those within it.
#define DEFINE_PACKET_STORE(name, vector, scalar)                                                   \
  static inline void name(vector value, uint2 corner, uint cols, uint rows, global scalar* image) { \
    scalar lanes[VW];                                                                               \
    STORE_LANES(value, lanes);                                                                      \
    const uint wide = packet_cols(rows), high = VW / wide;                                          \
    if (rows != 1u && corner.x + PACKET_COLS <= cols && corner.y + PACKET_ROWS <= rows) {           \
      for (uint y = 0u; y < PACKET_ROWS; ++y)                                                       \
        for (uint x = 0u; x < PACKET_COLS; ++x)                                                     \
          image[(corner.y + y) * cols + corner.x + x] = lanes[y * PACKET_COLS + x];                 \
      return;                                                                                       \
    }                                                                                               \
    for (uint y = 0u; y < high && corner.y + y < rows; ++y)                                         \
      for (uint x = 0u; x < wide && corner.x + x < cols; ++x)                                       \
        image[(corner.y + y) * cols + corner.x + x] = lanes[y * wide + x];                          \
  }
DEFINE_PACKET_STORE(store_packet, floatv, float)
DEFINE_PACKET_STORE(store_packet_ids, uintv, uint)

#endif
