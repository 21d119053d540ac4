// Nearest surface along rays of one origin, among triangles and tiny spheres (METHOD 10: primary visibility
// by ray casting in a BVH).
//
// Mapping: one work-item per packet of VW rays, PACKET_COLS x PACKET_ROWS neighbouring pixels (VW in a row
// for a list of rays); the host launches ceil(cols / PACKET_COLS) x ceil(rows / PACKET_ROWS).
//
// in: the tree (shared/bvh_records.h; metres, local frame); directions[3 * cols * rows]: unit, local frame,
// NaN = no ray; read only without use_camera. With it, ray (col, row) passes through pixel first + (col, row)
// + offset of the camera, distortion included; pixels no direction projects to have no ray.
//
// out, row-major: distance[cols * rows] along the ray, metres, +inf = nothing hit; id[cols * rows]: 0 =
// nothing, else the primitive's (1 + face, 0x80000000 + splat); with want_surface the planes
// surface[SURFACE_PLANES * cols * rows]: point, normal, radius; x is NaN where nothing is hit. The normal is
// unit: a face's towards the origin; that of a triangle with a radius and a splat's own, towards their
// scanner; where a splat has none the sphere's, and the radius is then negative. A triangle's radius is its
// record's: 0 on a face of the model.
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
#include "lib/bvh.h"
#include "lib/camera.h"
#include "shared/params_ray_cast.h"

// Tolerances along the ray within which a splat and a face compete: the tolerance holds across the face,
// whose cosine counts as no less than 1 / SLACK.
#define SLACK 10.0f

static inline float3 ray_direction(const RayCastParams* params, global const float* directions, uint2 at) {
  if (!params->use_camera) return vload3(at.y * params->cols + at.x, directions);
  const float2 pixel = (float2)((float)(params->first_col + at.x) + params->offset_x,
                                (float)(params->first_row + at.y) + params->offset_y);
  return camera_ray(&params->camera, pixel);
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

  float x[VW], y[VW], z[VW], limit[VW];
  for (uint lane = 0u; lane < VW; ++lane) {
    const uint2 at = packet_pixel(packet_x, packet_y, lane, params.rows);
    float3 direction = (float3)(0.0f, 0.0f, 1.0f);
    limit[lane] = -1.0f;
    if (at.x < params.cols && at.y < params.rows) {
      const float3 given = ray_direction(&params, directions, at);
      if (!isnan(given.x + given.y + given.z)) {
        direction = given;
        limit[lane] = INFINITY;
      }
    }
    x[lane] = direction.x, y[lane] = direction.y, z[lane] = direction.z;
  }
  const float3 origin = vload3(0, params.camera.centre);
  const PacketRays rays = bvh_rays(origin, LOAD_LANES(x), LOAD_LANES(y), LOAD_LANES(z));
  const PacketHit hit = bvh_nearest(&rays, nodes, triangles, spheres, sphere_surfaces, params.root,
                                    LOAD_LANES(limit), SLACK * params.tolerance_m);
  float t_triangle[VW], t_sphere[VW];
  uint triangle[VW], sphere[VW];
  STORE_LANES(hit.t_triangle, t_triangle);
  STORE_LANES(hit.t_sphere, t_sphere);
  STORE_LANES(hit.triangle, triangle);
  STORE_LANES(hit.sphere, sphere);

  const uint count = params.cols * params.rows;
  for (uint lane = 0u; lane < VW; ++lane) {
    const uint2 at = packet_pixel(packet_x, packet_y, lane, params.rows);
    if (at.x >= params.cols || at.y >= params.rows) continue;
    const uint i = at.y * params.cols + at.x;
    const float3 direction = (float3)(x[lane], y[lane], z[lane]);
    float3 normal = (float3)(0.0f);
    float t = INFINITY, radius = 0.0f;
    uint hit_id = 0u;
    int own_normal = 0;
    if (triangle[lane] != BVH_EMPTY) {
      global const TriangleRecord* face = triangles + triangle[lane];
      const float3 a = vload3(0, face->a);
      normal = normalize(cross(vload3(0, face->b) - a, vload3(0, face->c) - a));
      t = t_triangle[lane];
      hit_id = face->id;
      radius = face->radius;
      own_normal = radius > 0.0f;
    }
    const float behind = (t_sphere[lane] - t) * max(fabs(dot(normal, direction)), 1.0f / SLACK);
    if (sphere[lane] != BVH_EMPTY && (hit_id == 0u || behind <= params.tolerance_m)) {
      t = t_sphere[lane];
      hit_id = sphere_surfaces[sphere[lane]].id;
      normal = vload3(0, sphere_surfaces[sphere[lane]].normal);
      radius = spheres[sphere[lane]].radius;
      own_normal = 1;
      if (dot(normal, normal) == 0.0f) {
        normal = (origin + t * direction - vload3(0, spheres[sphere[lane]].centre)) / radius;
        radius = -radius;
        own_normal = 0;
      }
    }
    distance[i] = t;
    id[i] = hit_id;
    if (!params.want_surface) continue;
    if (!own_normal && dot(normal, direction) > 0.0f) normal = -normal;
    const float3 point = hit_id == 0u ? (float3)(NAN) : origin + t * direction;
    surface[SURFACE_X * count + i] = point.x;
    surface[SURFACE_Y * count + i] = point.y;
    surface[SURFACE_Z * count + i] = point.z;
    surface[SURFACE_NORMAL_X * count + i] = normal.x;
    surface[SURFACE_NORMAL_Y * count + i] = normal.y;
    surface[SURFACE_NORMAL_Z * count + i] = normal.z;
    surface[SURFACE_RADIUS * count + i] = radius;
  }
}
