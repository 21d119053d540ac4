// What a photograph has to do with a packet of surface points: which of them it sees, under what angle, how
// near to its border. Shared by blend_photos, rank_photos and blend_ranked.
#ifndef HYBRID_LIB_PHOTO_PACKET_H
#define HYBRID_LIB_PHOTO_PACKET_H
#include "lib/bvh_shadows.h"
#include "lib/packet_camera.h"
#include "shared/params_ray_cast.h"

// The surface points of a packet; x is NaN in lanes without one.
typedef struct PacketSurface {
  floatv x, y, z, normal_x, normal_y, normal_z, radius;
} PacketSurface;

static inline floatv surface_plane(global const float* surface, uint plane, uint count,
                                   const PacketPlace* at) {
  return load_packet_float(surface + plane * count, at, NAN);
}

static inline PacketSurface load_surface(global const float* surface, uint count, const PacketPlace* at) {
  PacketSurface points = {surface_plane(surface, SURFACE_X, count, at),
                          surface_plane(surface, SURFACE_Y, count, at),
                          surface_plane(surface, SURFACE_Z, count, at),
                          surface_plane(surface, SURFACE_NORMAL_X, count, at),
                          surface_plane(surface, SURFACE_NORMAL_Y, count, at),
                          surface_plane(surface, SURFACE_NORMAL_Z, count, at),
                          surface_plane(surface, SURFACE_RADIUS, count, at)};
  return points;
}

// Unit rays from a place to the points, their lengths, and the cosine at which they meet the surface: 1 where
// it has no known normal, negative from behind.
typedef struct PacketSight {
  floatv x, y, z, distance, facing;
} PacketSight;

static inline PacketSight packet_sight(const PacketSurface* points, float3 from) {
  PacketSight sight;
  const floatv x = points->x - from.x, y = points->y - from.y, z = points->z - from.z;
  sight.distance = sqrt(x * x + y * y + z * z);
  sight.x = x / sight.distance;
  sight.y = y / sight.distance;
  sight.z = z / sight.distance;
  const floatv towards =
      -(points->normal_x * sight.x + points->normal_y * sight.y + points->normal_z * sight.z);
  sight.facing = PICK(MASK(points->radius < 0.0f), (floatv)(1.0f), towards);
  return sight;
}

// Which points something at that sight faces by more than the least cosine: `least_of_samples` where they are
// samples. These have normals that are estimates, and what looks along a round surface sees past their discs.
static inline intv packet_faces(const PacketSurface* points, const PacketSight* sight, float least,
                                float least_of_samples) {
  const intv samples = MASK(points->radius > SURFACE_POLYGON_RADIUS);
  return MASK(sight->facing > PICK(samples, (floatv)(least_of_samples), (floatv)(least)));
}

// How near to the surface a shadow ray may hit something that does not count.
typedef struct ShadowTolerance {
  float sample_m, face_m;
} ShadowTolerance;

// Which of the lanes `asked` nothing hides from the photograph at `centre`. Shadow rays end before the
// surface, so that neighbouring samples, and samples and the face they lie on, do not shadow each other:
// among samples two radii or the tolerance, between samples and faces the tolerance, both along the surface
// normal and stretched by up to 5 at grazing angles, and two radii of the sample that would shade; among
// faces rounding only.
static inline intv packet_unhidden(const PacketSurface* points, const PacketSight* sight, float3 centre,
                                   ShadowTolerance tolerance, global const BvhNode* nodes,
                                   global const TriangleRecord* triangles, global const SphereRecord* spheres,
                                   uint root, intv asked) {
  const floatv stretch = 1.0f / max(sight->facing, (floatv)(0.2f));
  const floatv near_face =
      PICK(MASK(points->radius == 0.0f), (floatv)(tolerance.face_m), (floatv)(tolerance.sample_m));
  const floatv near_sphere = max(2.0f * fabs(points->radius), (floatv)(tolerance.sample_m));
  const PacketRays rays =
      bvh_rays(centre, PICK(asked, sight->x, (floatv)(0.0f)), PICK(asked, sight->y, (floatv)(0.0f)),
               PICK(asked, sight->z, (floatv)(1.0f)), asked);
  const intv blocked =
      bvh_occluded(&rays, nodes, triangles, spheres, root, sight->distance - near_face * stretch,
                   sight->distance - near_sphere * stretch, asked);
  return asked & ~blocked;
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

// Angle at the points between two sights, from the chord, because the cosine of a small angle says nothing of
// it.
static inline floatv packet_angle(const PacketSight* a, const PacketSight* b) {
  const floatv x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
  const floatv chord = sqrt(x * x + y * y + z * z);
  return 2.0f * arc_sine(min(0.5f * chord, (floatv)(1.0f)));
}

// 1 inside the photograph, falling to (almost) 0 over the last feather_px to its border. Where a panorama
// closes it has none.
static inline floatv packet_feather(const CameraRecord* camera, float feather_px, floatv column, floatv row) {
  if (!(feather_px > 0.0f)) return (floatv)(1.0f);
  floatv border = (floatv)(INFINITY);
  if (!(camera->flags & CAMERA_WRAPS)) border = min(column, (float)camera->width - column);
  if (!(camera->flags & CAMERA_ZENITH)) border = min(border, row);
  if (!(camera->flags & CAMERA_NADIR)) border = min(border, (float)camera->height - row);
  return min(max(border / feather_px, (floatv)(1e-6f)), (floatv)(1.0f));
}

#endif
