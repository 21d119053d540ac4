// Nearest surface along rays of one origin, or of some, among triangles and tiny spheres (METHOD 10: primary
// visibility by ray casting in a BVH).
//
// Mapping: one work-item per packet of VW rays, PACKET_COLS x PACKET_ROWS neighbouring pixels (VW in a row
// for a list of rays); the host launches ceil(cols / PACKET_COLS) x ceil(rows / PACKET_ROWS).
//
// in: the tree (shared/bvh_records.h; metres, local frame); directions[3 * cols * rows]: unit, local frame,
// NaN = no ray; read only without use_camera. In a row of them every rays_per_origin, a multiple of VW, may
// have an origin of their own: three floats each, local frame, after the last direction. With use_camera ray
// (col, row) passes through pixel first + (col, row) + offset of the camera, distortion included; pixels no
// direction projects to have no ray.
//
// out, row-major: distance[cols * rows] along the ray, metres, +inf = nothing hit; id[cols * rows]: 0 =
// nothing, else the primitive's (1 + face, 0x80000000 + splat); with want_surface the planes
// surface[SURFACE_PLANES * cols * rows]: point, normal, radius; x is NaN where nothing is hit. The normal is
// unit and towards the origin, also where a scan saw the other side: what stands there has a back a little
// nearer, and only photographs from the origin's side show it. Where a splat has no normal it is the
// sphere's, and the radius is then negative. A triangle's radius is its record's: 0 on a face of the model.
//
// A sphere with a normal stands for a flat patch, its disc across the normal: a large sphere of a sparse scan
// would bulge out of its surface, and a photograph projected on the bulge would shift by the radius. Shadow
// rays (blend_photos) and the tree keep to the spheres.
//
// Rule: a sphere whose point lies less than tolerance_m behind the nearest triangle's plane wins over it
// (measured along the triangle's normal, at most SLACK tolerances along the ray); a nearer one wins anyway.
// The rule looks at this ray alone, so nothing flickers.
//
// Defines: VW (1). Edges: an empty tree, rays that begin inside a sphere (it is ignored), two-sided
// triangles. Cost: per ray about 100 bytes read and 40 written, 300 flops per level of the tree shared by the
// packet. Reference twin: tests/reference/ray_cast.cpp.
#include "lib/bvh_nearest.h"
#include "lib/packet_camera.h"
#include "shared/params_ray_cast.h"

// Tolerances along the ray within which a splat and a face compete: the tolerance holds across the face,
// whose cosine counts as no less than 1 / SLACK.
#define SLACK 10.0f

// What the packet's rays hit.
typedef struct PacketSeen {
  floatv t, normal_x, normal_y, normal_z, radius;
  uintv id;
} PacketSeen;

// Directions of the packet's rays; NaN where there is none.
static inline void packet_directions(const RayCastParams* params, global const float* directions,
                                     uint2 corner, floatv* x, floatv* y, floatv* z) {
  float lane_x[VW], lane_y[VW], lane_z[VW];
  packet_steps(params->rows, lane_x, lane_y);
  const floatv col = (float)corner.x + LOAD_LANES(lane_x), row = (float)corner.y + LOAD_LANES(lane_y);
  if (params->use_camera) {
    packet_camera_rays(&params->camera, (float)params->first_col + col + params->offset_x,
                       (float)params->first_row + row + params->offset_y, x, y, z);
    const intv outside = MASK(col >= (float)params->cols) | MASK(row >= (float)params->rows);
    *x = PICK(outside, (floatv)(NAN), *x);
    return;
  }
  for (uint lane = 0u; lane < VW; ++lane) {
    const uint at_x = corner.x + (uint)lane_x[lane], at_y = corner.y + (uint)lane_y[lane];
    float3 given = (float3)(NAN);
    if (at_x < params->cols && at_y < params->rows) given = vload3(at_y * params->cols + at_x, directions);
    lane_x[lane] = given.x;
    lane_y[lane] = given.y;
    lane_z[lane] = given.z;
  }
  *x = LOAD_LANES(lane_x);
  *y = LOAD_LANES(lane_y);
  *z = LOAD_LANES(lane_z);
}

// Goes through a packet's different triangles, of which neighbouring rays share most: each once, for all
// lanes that hit it.
static inline void see_triangles(const PacketHit* hit, const PacketRays* rays,
                                 global const TriangleRecord* triangles, PacketSeen* seen) {
  uint lanes[VW];
  STORE_LANES(hit->triangle, lanes);
  intv left = MASK(hit->triangle != BVH_EMPTY);
  for (uint lane = 0u; lane < VW && ANY(left); ++lane) {
    const intv same = MASK(hit->triangle == lanes[lane]) & left;
    if (!ANY(same)) continue;
    left &= ~same;
    global const TriangleRecord* face = triangles + lanes[lane];
    const float3 a = vload3(0, face->a);
    const float3 normal = normalize(cross(vload3(0, face->b) - a, vload3(0, face->c) - a));
    const floatv away = normal.x * rays->x + normal.y * rays->y + normal.z * rays->z;
    const floatv sign = PICK(MASK(away > 0.0f), (floatv)(-1.0f), (floatv)(1.0f));
    seen->t = PICK(same, hit->t_triangle, seen->t);
    seen->normal_x = PICK(same, sign * normal.x, seen->normal_x);
    seen->normal_y = PICK(same, sign * normal.y, seen->normal_y);
    seen->normal_z = PICK(same, sign * normal.z, seen->normal_z);
    seen->radius = PICK(same, (floatv)(face->radius), seen->radius);
    seen->id = PICK(same, (uintv)(face->id), seen->id);
  }
}

static inline void see_spheres(const PacketHit* hit, const PacketRays* rays, float tolerance_m,
                               global const SphereRecord* spheres, global const SphereSurface* surfaces,
                               PacketSeen* seen) {
  const floatv slope = fabs(seen->normal_x * rays->x + seen->normal_y * rays->y + seen->normal_z * rays->z);
  const floatv behind = (hit->t_sphere - seen->t) * max(slope, (floatv)(1.0f / SLACK));
  const intv wins = MASK(hit->sphere != BVH_EMPTY) & (MASK(seen->id == 0u) | MASK(behind <= tolerance_m));
  if (!ANY(wins)) return;
  const uintv at = PICK(wins, hit->sphere, (uintv)(0u));
  const LaneRecords sphere = records_at(spheres[0].centre, at), surface = records_at(surfaces[0].normal, at);
  floatv x = surface.x, y = surface.y, z = surface.z;
  const intv round = MASK(x * x + y * y + z * z == 0.0f);
  const floatv away = x * rays->x + y * rays->y + z * rays->z;
  const floatv sign = PICK(MASK(away > 0.0f), (floatv)(-1.0f), (floatv)(1.0f));
  x = PICK(round, (rays->origin.x - sphere.x + hit->t_sphere * rays->x) / sphere.w, sign * x);
  y = PICK(round, (rays->origin.y - sphere.y + hit->t_sphere * rays->y) / sphere.w, sign * y);
  z = PICK(round, (rays->origin.z - sphere.z + hit->t_sphere * rays->z) / sphere.w, sign * z);
  seen->t = PICK(wins, hit->t_sphere, seen->t);
  seen->normal_x = PICK(wins, x, seen->normal_x);
  seen->normal_y = PICK(wins, y, seen->normal_y);
  seen->normal_z = PICK(wins, z, seen->normal_z);
  seen->radius = PICK(wins, PICK(round, -sphere.w, sphere.w), seen->radius);
  seen->id = PICK(wins, BITS_OF_LANES(surface.w), seen->id);
}

kernel void ray_cast(const RayCastParams params, global const BvhNode* restrict nodes,
                     global const TriangleRecord* restrict triangles,
                     global const SphereRecord* restrict spheres,
                     global const SphereSurface* restrict sphere_surfaces,
                     global const float* restrict directions, global float* restrict distance,
                     global uint* restrict id, global float* restrict surface) {
  const uint packet_x = get_global_id(0), packet_y = get_global_id(1);
  const uint2 corner = packet_pixel(packet_x, packet_y, 0u, params.rows);
  if (corner.x >= params.cols || corner.y >= params.rows) return;

  floatv x, y, z;
  packet_directions(&params, directions, corner, &x, &y, &z);
  const intv used = MASK(x + y + z == x + y + z);  // no NaN
  x = PICK(used, x, (floatv)(0.0f)), y = PICK(used, y, (floatv)(0.0f)), z = PICK(used, z, (floatv)(1.0f));
  const float3 origin =
      params.rays_per_origin
          ? vload3(params.cols * params.rows + corner.x / params.rays_per_origin, directions)
          : vload3(0, params.camera.centre);
  const PacketRays rays = bvh_rays(origin, x, y, z, used);
  const PacketHit hit =
      bvh_nearest(&rays, nodes, triangles, spheres, sphere_surfaces, params.root,
                  PICK(used, (floatv)(INFINITY), (floatv)(-1.0f)), SLACK * params.tolerance_m);
  const floatv none = (floatv)(0.0f);
  PacketSeen seen = {(floatv)(INFINITY), none, none, none, none, (uintv)(0u)};
  see_triangles(&hit, &rays, triangles, &seen);
  see_spheres(&hit, &rays, params.tolerance_m, spheres, sphere_surfaces, &seen);

  const uint count = params.cols * params.rows;
  const PacketPlace place = packet_place(corner, params.cols, params.rows);
  store_packet_float(seen.t, &place, distance);
  store_packet_uint(seen.id, &place, id);
  if (!params.want_surface) return;
  const floatv reach = PICK(MASK(seen.id != 0u), seen.t, (floatv)(NAN));
  const floatv planes[SURFACE_PLANES] = {rays.origin.x + reach * x,
                                         rays.origin.y + reach * y,
                                         rays.origin.z + reach * z,
                                         seen.normal_x,
                                         seen.normal_y,
                                         seen.normal_z,
                                         seen.radius};
  for (uint plane = 0u; plane < SURFACE_PLANES; ++plane)
    store_packet_float(planes[plane], &place, surface + plane * count);
}
