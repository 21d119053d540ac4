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

// Where a packet's lanes lie in images of cols x rows that are stored row by row.
typedef struct PacketPlace {
  uint first, cols;  // index of the first lane's pixel; from row to row
  uint wide, high;   // of the packet's pixels those within the image
  uint across;       // of its own
} PacketPlace;

static inline PacketPlace packet_place(uint2 corner, uint cols, uint rows) {
  PacketPlace place;
  place.first = corner.y * cols + corner.x;
  place.cols = cols;
  place.across = packet_cols(rows);
  place.wide = min(place.across, cols - corner.x);
  place.high = min((uint)VW / place.across, rows - corner.y);
  return place;
}

// A packet's pixels of an image, `fill` beyond its border; and back, those within it.
#if VW == 16
#define PACKET_ROWS_OF(from, step)                                               \
  (vload4(0, from), vload4(0, (from) + (step)), vload4(0, (from) + 2u * (step)), \
   vload4(0, (from) + 3u * (step)))
#define PACKET_ROWS_TO(value, to, step)          \
  vstore4((value).lo.lo, 0, to);                 \
  vstore4((value).lo.hi, 0, (to) + (step));      \
  vstore4((value).hi.lo, 0, (to) + 2u * (step)); \
  vstore4((value).hi.hi, 0, (to) + 3u * (step))
#elif VW == 8
#define PACKET_ROWS_OF(from, step) (vload4(0, from), vload4(0, (from) + (step)))
#define PACKET_ROWS_TO(value, to, step) \
  vstore4((value).lo, 0, to);           \
  vstore4((value).hi, 0, (to) + (step))
#elif VW == 4
#define PACKET_ROWS_OF(from, step) (vload2(0, from), vload2(0, (from) + (step)))
#define PACKET_ROWS_TO(value, to, step) \
  vstore2((value).lo, 0, to);           \
  vstore2((value).hi, 0, (to) + (step))
#else
#define PACKET_ROWS_OF(from, step) (*(from))
#define PACKET_ROWS_TO(value, to, step) *(to) = (value)
#endif

#define DEFINE_PACKET_IMAGE(type, vector, scalar)                                                           \
  static inline vector load_packet_##type(global const scalar* image, const PacketPlace* at, scalar fill) { \
    if (at->across == PACKET_COLS && at->wide == PACKET_COLS && at->high == PACKET_ROWS)                    \
      return (vector)PACKET_ROWS_OF(image + at->first, at->cols);                                           \
    scalar lanes[VW];                                                                                       \
    for (uint k = 0u; k < VW; ++k) {                                                                        \
      const uint x = k % at->across, y = k / at->across;                                                    \
      lanes[k] = x < at->wide && y < at->high ? image[at->first + y * at->cols + x] : fill;                 \
    }                                                                                                       \
    return LOAD_LANES(lanes);                                                                               \
  }                                                                                                         \
  static inline void store_packet_##type(vector value, const PacketPlace* at, global scalar* image) {       \
    if (at->across == PACKET_COLS && at->wide == PACKET_COLS && at->high == PACKET_ROWS) {                  \
      PACKET_ROWS_TO(value, image + at->first, at->cols);                                                   \
      return;                                                                                               \
    }                                                                                                       \
    scalar lanes[VW];                                                                                       \
    STORE_LANES(value, lanes);                                                                              \
    for (uint y = 0u; y < at->high; ++y)                                                                    \
      for (uint x = 0u; x < at->wide; ++x) image[at->first + y * at->cols + x] = lanes[y * at->across + x]; \
  }
DEFINE_PACKET_IMAGE(float, floatv, float)
DEFINE_PACKET_IMAGE(int, intv, int)
DEFINE_PACKET_IMAGE(uint, uintv, uint)

#endif
