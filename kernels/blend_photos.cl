// Adds one photograph to the colours of surface points: view-dependent projection of photographs (METHOD 10;
// weights of Facade: Debevec, Taylor, Malik 1996; two frequency bands, the paper's reference 13).
// A photograph is seen at point X when X projects inside it, the surface faces it and the ray from its centre
// to X meets nothing before X. Its weight is feather / (angle + one pixel), the angle between the rays from X
// to the eye and to the photograph's centre. The host launches this once per photograph, in index order, so
// their number has no limit; resolve_blend makes the colours.
// Mapping: one work-item per packet of VW points, as in ray_cast.cl.
// in: the tree; surface[SURFACE_PLANES * cols * rows] as ray_cast writes it (x NaN = no surface; radius > 0:
// a splat with a known normal, < 0: one without, which faces everything, 0: a face; the normal points to the
// eye side); photo[4 * width * height]: sRGB bytes; low[4 * width * height]: half, linear light (BLEND_DUAL
// only); linear[256]: light of an sRGB byte. in/out: sums[BLEND_PLANES * cols * rows], seen[cols * rows] =
// photographs so far that see the point, best[cols * rows] = the heaviest so far (-1 none). Shadow rays end
// before the surface, so that neighbouring samples, and samples and the face they lie on, do not shadow each
// other: among samples two radii or the tolerance, between samples and faces the tolerance, both along the
// surface normal and stretched by up to 5 at grazing angles; among faces rounding only. Defines: VW (1).
// Edges: a point at the photograph's very border weighs almost nothing but counts as seen. Cost: 28 bytes of
// surface, 24 of photograph and 72 of sums per seen point, one shadow ray. Reference twin:
// tests/reference/blend_photos.cpp.
#include "lib/bvh.h"
#include "lib/camera.h"
#include "shared/params_blend_photos.h"

// The four pixels around a position and their shares; the image goes on beyond its border.
typedef struct Bilinear {
  uint pixel[4];
  float share[4];
} Bilinear;

static inline Bilinear bilinear_at(const CameraRecord* camera, float2 position) {
  const float x = clamp(position.x - 0.5f, 0.0f, (float)(camera->width - 1u));
  const float y = clamp(position.y - 0.5f, 0.0f, (float)(camera->height - 1u));
  const uint x0 = (uint)x, y0 = (uint)y;
  const uint x1 = min(x0 + 1u, camera->width - 1u), y1 = min(y0 + 1u, camera->height - 1u);
  const float right = x - (float)x0, below = y - (float)y0;
  Bilinear at = {
      {y0 * camera->width + x0, y0 * camera->width + x1, y1 * camera->width + x0, y1 * camera->width + x1},
      {(1.0f - right) * (1.0f - below), right * (1.0f - below), (1.0f - right) * below, right * below}};
  return at;
}

static inline float3 light_at(const Bilinear* at, global const uchar* photo, global const float* linear) {
  float3 light = (float3)(0.0f);
  for (int k = 0; k < 4; ++k) {
    const uchar4 bytes = vload4(at->pixel[k], photo);
    light += at->share[k] * (float3)(linear[bytes.x], linear[bytes.y], linear[bytes.z]);
  }
  return light;
}

static inline float3 low_at(const Bilinear* at, global const half* low) {
  float3 light = (float3)(0.0f);
  for (int k = 0; k < 4; ++k) light += at->share[k] * vload_half4(at->pixel[k], low).xyz;
  return light;
}

static inline float feather(const BlendPhotosParams* params, float2 position) {
  const float border = min(min(position.x, (float)params->camera.width - position.x),
                           min(position.y, (float)params->camera.height - position.y));
  return params->feather_px > 0.0f ? clamp(border / params->feather_px, 1e-6f, 1.0f) : 1.0f;
}

kernel void blend_photos(const BlendPhotosParams params, global const BvhNode* restrict nodes,
                         global const TriangleRecord* restrict triangles,
                         global const SphereRecord* restrict spheres, global const float* restrict surface,
                         global const uchar* restrict photo, global const half* restrict low,
                         global const float* restrict linear, global float* restrict sums,
                         global uint* restrict seen, global int* restrict best) {
  const uint packet_x = get_global_id(0), packet_y = get_global_id(1);
  const uint2 corner = packet_pixel(packet_x, packet_y, 0u, params.rows);
  if (corner.x >= params.cols || corner.y >= params.rows) return;
  const uint count = params.cols * params.rows;
  const float3 centre = vload3(0, params.camera.centre);

  float x[VW], y[VW], z[VW], far_triangle[VW], far_sphere[VW];
  float2 position[VW];
  int asked[VW];
  int any_asked = 0;
  for (uint lane = 0u; lane < VW; ++lane) {
    const uint2 at = packet_pixel(packet_x, packet_y, lane, params.rows);
    x[lane] = 0.0f, y[lane] = 0.0f, z[lane] = 1.0f;
    far_triangle[lane] = far_sphere[lane] = -1.0f;
    asked[lane] = 0;
    if (at.x >= params.cols || at.y >= params.rows) continue;
    const uint i = at.y * params.cols + at.x;
    const float3 point = (float3)(surface[SURFACE_X * count + i], surface[SURFACE_Y * count + i],
                                  surface[SURFACE_Z * count + i]);
    float depth;
    if (isnan(point.x) || !camera_project(&params.camera, point, &position[lane], &depth)) continue;
    const float3 to_point = point - centre;
    const float distance = length(to_point);
    const float3 direction = to_point / distance;
    const float3 normal =
        (float3)(surface[SURFACE_NORMAL_X * count + i], surface[SURFACE_NORMAL_Y * count + i],
                 surface[SURFACE_NORMAL_Z * count + i]);
    const float radius = surface[SURFACE_RADIUS * count + i];
    const float facing = radius < 0.0f ? 1.0f : -dot(normal, direction);
    if (!(facing > 0.0f)) continue;
    const float stretch = 1.0f / max(facing, 0.2f);
    const float near_face = radius == 0.0f ? params.face_tolerance_m : params.tolerance_m;
    far_triangle[lane] = distance - near_face * stretch;
    far_sphere[lane] = distance - max(params.tolerance_m, 2.0f * fabs(radius)) * stretch;
    x[lane] = direction.x, y[lane] = direction.y, z[lane] = direction.z;
    asked[lane] = any_asked = -1;
  }
  if (!any_asked) return;

  const PacketRays rays = bvh_rays(centre, LOAD_LANES(x), LOAD_LANES(y), LOAD_LANES(z));
  const intv blocked = bvh_occluded(&rays, nodes, triangles, spheres, params.root, LOAD_LANES(far_triangle),
                                    LOAD_LANES(far_sphere), LOAD_LANES(asked));
  int visible[VW];
  STORE_LANES(LOAD_LANES(asked) & ~blocked, visible);

  for (uint lane = 0u; lane < VW; ++lane) {
    if (!visible[lane]) continue;
    const uint2 at = packet_pixel(packet_x, packet_y, lane, params.rows);
    const uint i = at.y * params.cols + at.x;
    const float3 point = (float3)(surface[SURFACE_X * count + i], surface[SURFACE_Y * count + i],
                                  surface[SURFACE_Z * count + i]);
    const float3 to_eye = normalize(vload3(0, params.eye) - point);
    const float3 to_photograph = -(float3)(x[lane], y[lane], z[lane]);
    // From the chord, because the cosine of a small angle says nothing of it.
    const float angle = 2.0f * asin(min(0.5f * length(to_eye - to_photograph), 1.0f));
    const float weight = feather(&params, position[lane]) / (angle + params.pixel_rad);

    const Bilinear around = bilinear_at(&params.camera, position[lane]);
    const float3 light = light_at(&around, photo, linear);
    const float3 smooth = params.mode == BLEND_DUAL ? low_at(&around, low) : light;
    sums[BLEND_SUM_R * count + i] += weight * smooth.x;
    sums[BLEND_SUM_G * count + i] += weight * smooth.y;
    sums[BLEND_SUM_B * count + i] += weight * smooth.z;
    sums[BLEND_SUM_WEIGHT * count + i] += weight;
    seen[i] += 1u;
    if (weight > sums[BLEND_BEST_WEIGHT * count + i]) {
      const float3 kept = params.mode == BLEND_DUAL ? light - smooth : light;
      sums[BLEND_BEST_R * count + i] = kept.x;
      sums[BLEND_BEST_G * count + i] = kept.y;
      sums[BLEND_BEST_B * count + i] = kept.z;
      sums[BLEND_BEST_WEIGHT * count + i] = weight;
      best[i] = params.photograph;
    }
  }
}
