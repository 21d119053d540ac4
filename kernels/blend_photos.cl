// Adds one photograph to the colours of surface points: view-dependent projection of photographs (METHOD 10;
// weights of Facade: Debevec, Taylor, Malik 1996; two frequency bands, the paper's reference 13).
// A photograph sees point X when X projects inside it, the surface faces it and the ray from its centre to X
// meets nothing before X. Its weight is feather / (angle + one pixel), the angle between the rays from X to
// the eye and to the photograph's centre. The host launches this once per photograph, in index order, so
// their number has no limit; resolve_blend makes the colours.
//
// Mapping: one work-item per packet of VW points, as in ray_cast.cl.
//
// in: the tree; surface[SURFACE_PLANES * cols * rows] as ray_cast writes it (x NaN = no surface; radius > 0:
// a splat with a known normal, < 0: one without, which faces everything, 0: a face);
// photo[4 * width * height]: sRGB bytes; low[4 * width * height]: half, linear light (BLEND_DUAL only);
// linear[256]: light of an sRGB byte.
//
// in/out: sums[BLEND_PLANES * cols * rows]; seen[cols * rows] = photographs so far that see the point;
// best[cols * rows] = the heaviest so far (-1 none).
//
// Shadow rays end before the surface, so that neighbouring samples, and samples and the face they lie on, do
// not shadow each other: among samples two radii or the tolerance, between samples and faces the tolerance,
// both along the surface normal and stretched by up to 5 at grazing angles, and two radii of the sample that
// would shade; among faces rounding only.
//
// Defines: VW (1). Edges: a point at the photograph's very border weighs almost nothing but counts as seen.
// Cost: 28 bytes of surface, 48 of photograph and 72 of sums per seen point, one shadow ray.
// Reference twin: tests/reference/blend_photos.cpp.
#include "lib/bvh.h"
#include "lib/camera.h"
#include "shared/params_blend_photos.h"

// The surface points of a packet; x is NaN in lanes without one.
typedef struct PacketSurface {
  floatv x, y, z, normal_x, normal_y, normal_z, radius;
} PacketSurface;

static inline floatv surface_plane(global const float* surface, uint plane, uint count, const uint* index) {
  float lanes[VW];
  for (uint lane = 0u; lane < VW; ++lane)
    lanes[lane] = index[lane] == BVH_EMPTY ? NAN : surface[plane * count + index[lane]];
  return LOAD_LANES(lanes);
}

static inline PacketSurface load_surface(global const float* surface, uint count, const uint* index) {
  PacketSurface points = {surface_plane(surface, SURFACE_X, count, index),
                          surface_plane(surface, SURFACE_Y, count, index),
                          surface_plane(surface, SURFACE_Z, count, index),
                          surface_plane(surface, SURFACE_NORMAL_X, count, index),
                          surface_plane(surface, SURFACE_NORMAL_Y, count, index),
                          surface_plane(surface, SURFACE_NORMAL_Z, count, index),
                          surface_plane(surface, SURFACE_RADIUS, count, index)};
  return points;
}

// Arc sine of 0..1 to 3e-7 (Cephes asinf): the same bits on every device and for every VW.
static inline floatv arc_sine(floatv h) {
  const intv large = MASK(h > 0.5f);
  const floatv z = PICK(large, 0.5f * (1.0f - h), h * h);
  const floatv s = PICK(large, sqrt(z), h);
  const floatv series =
      (((4.2163199048e-2f * z + 2.4181311049e-2f) * z + 4.5470025998e-2f) * z + 7.4953002686e-2f) * z +
      1.6666752422e-1f;
  const floatv small = series * z * s + s;
  return PICK(large, 1.57079637f - 2.0f * small, small);
}

// feather / (angle + one pixel) for points seen at `column`, `row` along unit rays (x, y, z) from the
// photograph.
static inline floatv photograph_weight(const BlendPhotosParams* params, const PacketSurface* points,
                                       floatv column, floatv row, floatv x, floatv y, floatv z) {
  const floatv eye_x = params->eye[0] - points->x, eye_y = params->eye[1] - points->y,
               eye_z = params->eye[2] - points->z;
  const floatv away = sqrt(eye_x * eye_x + eye_y * eye_y + eye_z * eye_z);
  // The angle from the chord, because the cosine of a small angle says nothing of it.
  const floatv chord_x = eye_x / away + x, chord_y = eye_y / away + y, chord_z = eye_z / away + z;
  const floatv chord = sqrt(chord_x * chord_x + chord_y * chord_y + chord_z * chord_z);
  const floatv angle = 2.0f * arc_sine(min(0.5f * chord, (floatv)(1.0f)));
  const floatv border =
      min(min(column, (float)params->camera.width - column), min(row, (float)params->camera.height - row));
  floatv feather = (floatv)(1.0f);
  if (params->feather_px > 0.0f)
    feather = min(max(border / params->feather_px, (floatv)(1e-6f)), (floatv)(1.0f));
  return feather / (angle + params->pixel_rad);
}

// The four pixels around a position and their shares; the image goes on beyond its border.
typedef struct Bilinear {
  uint pixel[4];
  float share[4];
} Bilinear;

static inline Bilinear bilinear_at(const CameraRecord* camera, float column, float row) {
  const float x = clamp(column - 0.5f, 0.0f, (float)(camera->width - 1u));
  const float y = clamp(row - 0.5f, 0.0f, (float)(camera->height - 1u));
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

// Adds a photograph's light of one point to what is summed for it.
static inline void add_light(const BlendPhotosParams* params, float3 light, float3 smooth, float weight,
                             uint count, uint i, global float* sums, global uint* seen, global int* best) {
  sums[BLEND_SUM_R * count + i] += weight * smooth.x;
  sums[BLEND_SUM_G * count + i] += weight * smooth.y;
  sums[BLEND_SUM_B * count + i] += weight * smooth.z;
  sums[BLEND_SUM_WEIGHT * count + i] += weight;
  seen[i] += 1u;
  if (weight > sums[BLEND_BEST_WEIGHT * count + i]) {
    const float3 kept = params->mode == BLEND_DUAL ? light - smooth : light;
    sums[BLEND_BEST_R * count + i] = kept.x;
    sums[BLEND_BEST_G * count + i] = kept.y;
    sums[BLEND_BEST_B * count + i] = kept.z;
    sums[BLEND_BEST_WEIGHT * count + i] = weight;
    best[i] = params->photograph;
  }
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
  uint index[VW];
  for (uint lane = 0u; lane < VW; ++lane) {
    const uint2 at = packet_pixel(packet_x, packet_y, lane, params.rows);
    index[lane] = at.x < params.cols && at.y < params.rows ? at.y * params.cols + at.x : BVH_EMPTY;
  }
  const PacketSurface points = load_surface(surface, count, index);
  floatv column, row;
  intv asked = camera_project(&params.camera, points.x, points.y, points.z, &column, &row);

  const float3 centre = vload3(0, params.camera.centre);
  floatv x = points.x - centre.x, y = points.y - centre.y, z = points.z - centre.z;
  const floatv distance = sqrt(x * x + y * y + z * z);
  x /= distance, y /= distance, z /= distance;
  const floatv towards = -(points.normal_x * x + points.normal_y * y + points.normal_z * z);
  const floatv facing = PICK(MASK(points.radius < 0.0f), (floatv)(1.0f), towards);
  asked &= MASK(facing > 0.0f);
  if (!ANY(asked)) return;

  const floatv stretch = 1.0f / max(facing, (floatv)(0.2f));
  const floatv near_face =
      PICK(MASK(points.radius == 0.0f), (floatv)(params.face_tolerance_m), (floatv)(params.tolerance_m));
  const floatv near_sphere = max(2.0f * fabs(points.radius), (floatv)(params.tolerance_m));
  const PacketRays rays = bvh_rays(centre, PICK(asked, x, (floatv)(0.0f)), PICK(asked, y, (floatv)(0.0f)),
                                   PICK(asked, z, (floatv)(1.0f)));
  const intv blocked = bvh_occluded(&rays, nodes, triangles, spheres, params.root,
                                    distance - near_face * stretch, distance - near_sphere * stretch, asked);

  int visible[VW];
  float columns[VW], rows[VW], weights[VW];
  STORE_LANES(asked & ~blocked, visible);
  STORE_LANES(column, columns);
  STORE_LANES(row, rows);
  STORE_LANES(photograph_weight(&params, &points, column, row, x, y, z), weights);
  for (uint lane = 0u; lane < VW; ++lane) {
    if (!visible[lane]) continue;
    const Bilinear around = bilinear_at(&params.camera, columns[lane], rows[lane]);
    const float3 light = light_at(&around, photo, linear);
    const float3 smooth = params.mode == BLEND_DUAL ? low_at(&around, low) : light;
    add_light(&params, light, smooth, weights[lane], count, index[lane], sums, seen, best);
  }
}
