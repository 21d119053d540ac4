// The low band of a photograph: Gaussian in linear light that never reaches across a visibility edge (METHOD
// 10, dual interpolation by frequency). Two launches, along rows and then along columns. Each walks from the
// centre outwards, both ways, to the first visibility edge: two neighbouring pixels of different ids (a face
// is planar, however steep) whose distances from the camera differ by tolerance_m + slope * pixel_rad *
// distance or more. Sky (id 0) ends at anything else. What was walked over is renormalised.
//
// Mapping: one work-item per pixel.
//
// in: photo[4 * width * height]: sRGB bytes, read when vertical is 0; rows[4 * width * height]: half, linear
// light, the first pass's result, read when vertical is 1; linear[3 * 256]: light of an sRGB byte, per
// channel; weights[radius + 1] by distance in pixels; distance, id[width * height] as ray_cast sees from this
// camera
// (+inf, 0: nothing).
//
// out: blurred[4 * width * height], from pixel `first` on: half, linear light; the fourth channel is 1, or 0
// like the others where there was nothing but masked pixels.
//
// Define: BLUR_FLAGS: of the photograph's camera, CAMERA_WRAPS, CAMERA_HAS_MASK; asked per tap they cost a
// photograph without them two thirds of its time.
//
// Edges: outside the image there is no tap; a full panorama (CAMERA_WRAPS) goes on along the row at its other
// side. Masked pixels (CAMERA_HAS_MASK, alpha 0) are no taps. Cost: (2 radius + 1) * 16 bytes, mostly from
// cache, and 10 flops per tap. Reference twin: tests/reference/blur_photo.cpp.
#include "shared/params_blur_photo.h"

#ifndef BLUR_FLAGS
#define BLUR_FLAGS 0
#endif

constant int kWraps = (BLUR_FLAGS & CAMERA_WRAPS) != 0, kMasked = (BLUR_FLAGS & CAMERA_HAS_MASK) != 0;

kernel void blur_photo(const BlurPhotoParams params, global const uchar* restrict photo,
                       global const half* restrict rows, global const float* restrict linear,
                       global const float* restrict weights, global const float* restrict distance,
                       global const uint* restrict id, global half* restrict blurred) {
  const uint x = get_global_id(0), y = get_global_id(1);
  if (x >= params.width || y >= params.height) return;
  const uint centre = y * params.width + x;
  const uint along = params.vertical ? y : x;
  const uint extent = params.vertical ? params.height : params.width;
  const uint stride = params.vertical ? params.width : 1u;
  const uint wraps = kWraps && !params.vertical;
  const uint before = min(wraps ? extent - 1u : along, params.radius);
  const uint after = min(wraps ? extent - 1u : extent - 1u - along, params.radius);

  float4 sum = (float4)(0.0f);
  for (int side = -1; side <= 1; side += 2) {
    const uint reach = side < 0 ? before : after;
    uint at = centre;
    for (uint apart = 0u; apart <= reach; ++apart) {
      if (apart > 0u) {
        const uint last = at;
        at = side < 0 ? at - stride : at + stride;
        if (wraps && side < 0 && apart == along + 1u) at += params.width;
        if (wraps && side > 0 && apart == extent - along) at -= params.width;
        const float limit = params.tolerance_m + params.slope * params.pixel_rad * distance[last];
        // NaN between two of sky, whose ids are equal.
        if (id[at] != id[last] && !(fabs(distance[at] - distance[last]) < limit)) break;
      } else if (side > 0) {
        continue;  // the centre counts once
      }
      float4 light;
      if (params.vertical) {
        light = vload_half4(at, rows);
        if (!kMasked) light.w = 1.0f;
      } else {
        const uchar4 bytes = vload4(at, photo);
        light = (float4)(linear[bytes.x], linear[256u + bytes.y], linear[512u + bytes.z], 1.0f);
        if (kMasked && bytes.w == 0) light = (float4)(0.0f);
      }
      sum += weights[apart] * light;
    }
  }
  vstore_half4_rte(!kMasked || sum.w > 0.0f ? sum / sum.w : sum, params.first + centre, blurred);
}
