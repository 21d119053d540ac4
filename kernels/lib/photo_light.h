// A photograph's light at the positions of a packet, and what is summed of it per surface point.
#ifndef HYBRID_LIB_PHOTO_LIGHT_H
#define HYBRID_LIB_PHOTO_LIGHT_H
#include "lib/packet.h"
#include "shared/params_blend_photos.h"

// The four pixels around each position and their shares; the image goes on beyond its border, and a full
// panorama on its other side.
typedef struct Bilinear {
  uintv pixel[4];
  floatv share[4];
} Bilinear;

// Of the lanes `seen`; the others get the first pixel. Through a pointer: oclgrind's compiler stumbles over
// structs returned through two inlined functions.
static inline void bilinear_at(const CameraRecord* camera, floatv column, floatv row, intv seen,
                               Bilinear* at) {
  const uint wraps = camera->flags & CAMERA_WRAPS;
  const float width = (float)camera->width;
  floatv x = PICK(seen, column, (floatv)(0.5f)) - 0.5f;
  if (wraps) x = PICK(MASK(x < 0.0f), x + width, x);
  // A full turn reaches up to the width, beyond the last pixel's centre.
  x = min(max(x, (floatv)(0.0f)), (floatv)(wraps ? nextafter(width, 0.0f) : (float)(camera->width - 1u)));
  const floatv y = min(max(PICK(seen, row, (floatv)(0.5f)) - 0.5f, (floatv)(0.0f)),
                       (floatv)((float)(camera->height - 1u)));
  const uintv x0 = whole_of(x), y0 = whole_of(y);
  const uintv beyond = wraps ? (uintv)(0u) : (uintv)(camera->width - 1u);
  const uintv x1 = PICK(MASK(x0 + 1u < camera->width), x0 + 1u, beyond);
  const uintv y1 = min(y0 + 1u, (uintv)(camera->height - 1u));
  const floatv right = x - floor(x), below = y - floor(y);
  at->pixel[0] = y0 * camera->width + x0;
  at->pixel[1] = y0 * camera->width + x1;
  at->pixel[2] = y1 * camera->width + x0;
  at->pixel[3] = y1 * camera->width + x1;
  at->share[0] = (1.0f - right) * (1.0f - below);
  at->share[1] = right * (1.0f - below);
  at->share[2] = (1.0f - right) * below;
  at->share[3] = right * below;
}

// Asks for the memory around the positions, so that it comes while shadow rays are on their way: waiting for
// it was a third of all time.
static inline void fetch_light(const Bilinear* at, BlendMode mix, uint photo_pixels,
                               global const uchar* photo, global const half* low) {
  uint upper[VW], lower[VW];
  STORE_LANES(at->pixel[0], upper);
  STORE_LANES(at->pixel[2], lower);
  for (uint lane = 0u; lane < VW; ++lane) {
    FETCH(photo + (size_t)4 * upper[lane]);
    FETCH(photo + (size_t)4 * lower[lane]);
  }
  for (uint band = 0u; mix.mode == BLEND_BANDS && band + 1u < mix.bands; ++band)
    for (uint lane = 0u; lane < VW; ++lane) {
      FETCH(low + (size_t)4 * ((size_t)band * photo_pixels + upper[lane]));
      FETCH(low + (size_t)4 * ((size_t)band * photo_pixels + lower[lane]));
    }
}

// Which positions are the photograph's own, none of whose pixels the mask takes out?
static inline intv is_photograph(const CameraRecord* camera, const Bilinear* at, global const uchar* photo) {
  intv whole = MASK((uintv)(0u) == 0u);
  if (!(camera->flags & CAMERA_HAS_MASK)) return whole;
  for (int k = 0; k < 4; ++k)
    whole &=
        MASK(at->share[k] == 0.0f) | MASK((words_at((global const uint*)photo, at->pixel[k]) >> 24) != 0u);
  return whole;
}

typedef struct PacketLight {
  floatv r, g, b;
} PacketLight;

__attribute__((always_inline)) static inline floatv channel_at(const Bilinear* at, const uintv* bytes,
                                                               uint shift, global const float* linear) {
  return at->share[0] * entries_at(linear, (bytes[0] >> shift) & 255u) +
         at->share[1] * entries_at(linear, (bytes[1] >> shift) & 255u) +
         at->share[2] * entries_at(linear, (bytes[2] >> shift) & 255u) +
         at->share[3] * entries_at(linear, (bytes[3] >> shift) & 255u);
}

static inline PacketLight light_at(const Bilinear* at, global const uchar* photo,
                                   global const float* linear) {
  global const uint* pixels = (global const uint*)photo;
  const uintv bytes[4] = {words_at(pixels, at->pixel[0]), words_at(pixels, at->pixel[1]),
                          words_at(pixels, at->pixel[2]), words_at(pixels, at->pixel[3])};
  const PacketLight light = {channel_at(at, bytes, 0u, linear), channel_at(at, bytes, 8u, linear + 256),
                             channel_at(at, bytes, 16u, linear + 512)};
  return light;
}

static inline PacketLight low_at(const Bilinear* at, global const half* low) {
  PacketLight light = {(floatv)(0.0f), (floatv)(0.0f), (floatv)(0.0f)};
  for (int k = 0; k < 4; ++k) {
    const LanePairs halves = pairs_at((global const uint*)low, 2u * at->pixel[k]);
    light.r += at->share[k] * halves_of(halves.first);
    light.g += at->share[k] * halves_of(halves.first >> 16);
    light.b += at->share[k] * halves_of(halves.second);
  }
  return light;
}

// x^n, 0 <= x <= 1, by squaring: the same bits everywhere.
static inline floatv whole_power(floatv x, uint n) {
  floatv power = (floatv)(1.0f);
  for (; n != 0u; n >>= 1) {
    if (n & 1u) power *= x;
    x *= x;
  }
  return power;
}

// The sums of a packet's points: planes of `count` floats.
typedef struct PacketSums {
  PacketPlace place;
  uint count;
  intv seen;  // the lanes that something is added to
} PacketSums;

__attribute__((always_inline)) static inline void add_to_plane(const PacketSums* to, floatv kept,
                                                               floatv added, global float* plane) {
  const floatv before = load_packet_float(plane, &to->place, 0.0f);
  store_packet_float(PICK(to->seen, kept * before + added, before), &to->place, plane);
}

// Adds a band to those of heavier and lighter photographs, each by (weight / heaviest)^power: the heaviest
// rules, and hands over without a seam where another one becomes it. The sums are relative to the heaviest so
// far, so that no power leaves the range of floats. `at`: the band's red.
static inline void add_band(const PacketSums* to, PacketLight band, floatv weight, floatv heaviest,
                            uint power, global float* at) {
  const intv heavier = MASK(weight > heaviest);
  const floatv part = whole_power(PICK(heavier, heaviest, weight) / PICK(heavier, weight, heaviest), power);
  const floatv one = (floatv)(1.0f), kept = PICK(heavier, part, one), added = PICK(heavier, one, part);
  add_to_plane(to, kept, added * band.r, at);
  add_to_plane(to, kept, added * band.g, at + to->count);
  add_to_plane(to, kept, added * band.b, at + 2u * to->count);
  add_to_plane(to, kept, added, at + 3u * to->count);
}

// Splits the light into bands, adds all but the lowest, and returns that. `low` holds an image per Gaussian,
// the narrowest first: what a Gaussian takes away is a band (Burt and Adelson 1983).
static inline PacketLight add_bands(const PacketSums* to, const Bilinear* around, BlendMode mix,
                                    uint photo_pixels, PacketLight light, floatv weight, floatv heaviest,
                                    global const half* low, global float* sums) {
  for (uint band = 0u; band + 1u < mix.bands; ++band) {
    const PacketLight smooth = low_at(around, low + (size_t)4 * band * photo_pixels);
    const PacketLight rest = {light.r - smooth.r, light.g - smooth.g, light.b - smooth.b};
    const uint plane = band == 0u ? BLEND_BEST_R : BLEND_PLANES + BLEND_BAND_PLANES * (band - 1u);
    add_band(to, rest, weight, heaviest, mix.power[band], sums + (size_t)plane * to->count);
    light = smooth;
  }
  return light;
}

// Adds the light that photograph number `photograph`, of `photo_pixels` pixels, has at the positions.
static inline void add_light(const PacketSums* to, const Bilinear* around, BlendMode mix, int photograph,
                             uint photo_pixels, floatv weight, global const uchar* photo,
                             global const half* low, global const float* linear, global float* sums,
                             global int* best) {
  const size_t count = to->count;
  const floatv one = (floatv)(1.0f),
               heaviest = load_packet_float(sums + BLEND_BEST_WEIGHT * count, &to->place, 1.0f);
  const PacketLight light = light_at(around, photo, linear);
  const PacketLight smooth =
      mix.mode == BLEND_BANDS ? add_bands(to, around, mix, photo_pixels, light, weight, heaviest, low, sums)
                              : light;
  add_to_plane(to, one, weight * smooth.r, sums + BLEND_SUM_R * count);
  add_to_plane(to, one, weight * smooth.g, sums + BLEND_SUM_G * count);
  add_to_plane(to, one, weight * smooth.b, sums + BLEND_SUM_B * count);
  add_to_plane(to, one, weight, sums + BLEND_SUM_WEIGHT * count);
  PacketSums heavier = *to;
  heavier.seen = to->seen & MASK(weight > heaviest);
  if (!ANY(heavier.seen)) return;
  const floatv none = (floatv)(0.0f);
  if (mix.mode != BLEND_BANDS) {
    add_to_plane(&heavier, none, light.r, sums + BLEND_BEST_R * count);
    add_to_plane(&heavier, none, light.g, sums + BLEND_BEST_G * count);
    add_to_plane(&heavier, none, light.b, sums + BLEND_BEST_B * count);
    add_to_plane(&heavier, none, one, sums + BLEND_BEST_SHARE * count);
  }
  add_to_plane(&heavier, none, weight, sums + BLEND_BEST_WEIGHT * count);
  const intv before = load_packet_int(best, &to->place, -1);
  store_packet_int(PICK(heavier.seen, (intv)(photograph), before), &to->place, best);
}

#endif
