// The low band of a photograph: Gaussian in linear light that never reaches across a visibility edge (METHOD
// 10, dual interpolation by frequency). Two launches, along rows and then along columns; each leaves out the
// taps whose surface is another one than the centre's and renormalises, so that what arrives in two steps has
// crossed no edge either. Same surface: the same id (a face is planar, however steep), or distances from the
// camera that differ by less than tolerance_m + slope * (pixels apart) * pixel_rad * distance. Sky (id 0)
// blends with sky only.
//
// Mapping: one work-item per pixel.
//
// in: photo[4 * width * height]: sRGB bytes, read when vertical is 0; rows[4 * width * height]: half, linear
// light, the first pass's result, read when vertical is 1; linear[256]: light of an sRGB byte;
// weights[radius + 1] by distance in pixels; distance, id[width * height] as ray_cast sees from this camera
// (+inf, 0: nothing).
//
// out: blurred[4 * width * height]: half, linear light; the fourth channel is 1.
//
// Edges: outside the image there is no tap. Cost: (2 radius + 1) * 16 bytes, mostly from cache, and 10 flops
// per tap. Reference twin: tests/reference/blur_photo.cpp.
#include "shared/params_blur_photo.h"

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
  const uint before = min(along, params.radius), after = min(extent - 1u - along, params.radius);

  const float here = distance[centre];
  const uint here_id = id[centre];
  const float step = params.slope * params.pixel_rad * here;
  float4 sum = (float4)(0.0f);
  for (uint tap = 0u; tap <= before + after; ++tap) {
    const uint at = centre - before * stride + tap * stride;
    const uint apart = tap > before ? tap - before : before - tap;
    const float jump = fabs(distance[at] - here);  // NaN between two of sky, whose ids are equal
    if (id[at] != here_id && !(jump < params.tolerance_m + step * (float)apart)) continue;
    float3 light;
    if (params.vertical) {
      light = vload_half4(at, rows).xyz;
    } else {
      const uchar4 bytes = vload4(at, photo);
      light = (float3)(linear[bytes.x], linear[bytes.y], linear[bytes.z]);
    }
    sum += weights[apart] * (float4)(light, 1.0f);
  }
  vstore_half4_rte(sum / sum.w, centre, blurred);
}
