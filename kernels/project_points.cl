// Where a photograph sees points, and the rays back from there (METHOD 10's "X projects inside the image").
// It is lib/packet_camera.h and lib/camera.h and nothing else: the same code that blends photographs and
// casts a view's rays, laid open so that a reconstruction's own observations and the double-precision camera
// can be held against it.
//
// Mapping: one work-item per VW points; the host launches ceil(count / VW).
//
// in: points[3 * count], metres, local frame; the camera.
// out: pixels[2 * count]: column and row, the top left pixel's centre at (0.5, 0.5), NaN where the camera
// does not see the point; rays[3 * count]: unit, local frame, through that pixel, NaN where there is none.
//
// Defines: VW (1). Edges: NaN points, points behind the camera, beyond the radius of growth. Cost: 12 bytes
// read and 20 written per point, about 60 flops, and up to 20 steps of Newton's method of 60 each. Reference
// twin: tests/reference/project_points.cpp.
#include "lib/camera.h"
#include "lib/packet_camera.h"
#include "shared/params_project_points.h"

kernel void project_points(const ProjectPointsParams params, global const float* restrict points,
                           global float* restrict pixels, global float* restrict rays) {
  const uint first = get_global_id(0) * (uint)VW;
  if (first >= params.count) return;
  float x[VW], y[VW], z[VW];
  for (uint lane = 0u; lane < VW; ++lane) {
    const uint i = min(first + lane, params.count - 1u);
    x[lane] = points[3u * i], y[lane] = points[3u * i + 1u], z[lane] = points[3u * i + 2u];
  }
  floatv columns, rows;
  const intv mask =
      packet_project(&params.camera, LOAD_LANES(x), LOAD_LANES(y), LOAD_LANES(z), &columns, &rows);
  float column[VW], row[VW];
  int seen[VW];
  STORE_LANES(columns, column);
  STORE_LANES(rows, row);
  STORE_LANES(mask, seen);
  for (uint lane = 0u; lane < VW && first + lane < params.count; ++lane) {
    const uint i = first + lane;
    const float2 pixel = seen[lane] ? (float2)(column[lane], row[lane]) : (float2)(NAN);
    vstore2(pixel, i, pixels);
    vstore3(seen[lane] ? camera_ray(&params.camera, pixel) : (float3)(NAN), i, rays);
  }
}
