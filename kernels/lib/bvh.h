// Rays of one origin against the tree of triangles and spheres (shared/bvh_records.h), VW rays at a time.
// With one origin (the eye, the scanner, a photograph's centre: shadow rays run from there to the surface)
// all that depends on box, triangle or sphere and origin alone is scalar, once per packet. The answer is
// defined by the primitives, not by the order of traversal: equal distances go to the lower index, so every
// VW gives the same bits.
#ifndef HYBRID_LIB_BVH_H
#define HYBRID_LIB_BVH_H
#include "lib/packet.h"
#include "shared/bvh_records.h"

typedef struct PacketRays {
  float3 origin;
  floatv x, y, z;                          // unit directions
  floatv inverse_x, inverse_y, inverse_z;  // finite: tiny components count as 1e-18
} PacketRays;

// A direction's component, moved away from 0 so that its inverse times any distance stays finite.
static inline floatv bvh_inverse(floatv d) {
  const floatv tiny = PICK(MASK(d < 0.0f), (floatv)(-1e-18f), (floatv)(1e-18f));
  return 1.0f / PICK(MASK(fabs(d) < 1e-18f), tiny, d);
}

static inline PacketRays bvh_rays(float3 origin, floatv x, floatv y, floatv z) {
  PacketRays rays = {origin, x, y, z, bvh_inverse(x), bvh_inverse(y), bvh_inverse(z)};
  return rays;
}

// Distance at which the rays enter the box, INFINITY where they miss it before `bound`. The exit is widened
// by two roundings (Ize 2013), so that a box never hides what lies in it.
static inline floatv bvh_enter(const PacketRays* rays, global const float* low, global const float* high,
                               floatv bound) {
  const floatv x0 = (low[0] - rays->origin.x) * rays->inverse_x;
  const floatv x1 = (high[0] - rays->origin.x) * rays->inverse_x;
  const floatv y0 = (low[1] - rays->origin.y) * rays->inverse_y;
  const floatv y1 = (high[1] - rays->origin.y) * rays->inverse_y;
  const floatv z0 = (low[2] - rays->origin.z) * rays->inverse_z;
  const floatv z1 = (high[2] - rays->origin.z) * rays->inverse_z;
  const floatv near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), (floatv)(0.0f)));
  const floatv far = min(min(max(x0, x1), max(y0, y1)), max(z0, z1)) * 1.0000005f;
  return PICK(MASK(near <= min(far, bound)), near, (floatv)(INFINITY));
}

// Distance of the triangle along the rays, negative where they miss. Edge functions as in Pluecker
// coordinates (Davis et al., as in Embree): two triangles that share an edge compute the same bits for it
// with opposite signs, so that no ray slips between them. Two-sided.
static inline floatv bvh_triangle(const PacketRays* rays, global const TriangleRecord* triangle) {
  const float3 a = vload3(0, triangle->a) - rays->origin;
  const float3 b = vload3(0, triangle->b) - rays->origin;
  const float3 c = vload3(0, triangle->c) - rays->origin;
  const float3 e0 = c - a, e1 = a - b, e2 = b - c;
  const float3 m0 = cross(e0, c + a), m1 = cross(e1, a + b), m2 = cross(e2, b + c);
  const floatv u = m0.x * rays->x + m0.y * rays->y + m0.z * rays->z;
  const floatv v = m1.x * rays->x + m1.y * rays->y + m1.z * rays->z;
  const floatv w = m2.x * rays->x + m2.y * rays->y + m2.z * rays->z;
  const intv inside = MASK(min(min(u, v), w) >= 0.0f) | MASK(max(max(u, v), w) <= 0.0f);
  if (!ANY(inside)) return (floatv)(-1.0f);
  const float3 normal = cross(e1, e0);
  const floatv t =
      dot(a, normal) / (normal.x * rays->x + normal.y * rays->y + normal.z * rays->z);  // NaN when parallel
  return PICK(inside & MASK(t > 0.0f), t, (floatv)(-1.0f));
}

// Distance at which the rays enter the sphere, negative where they miss it or begin inside or behind it. The
// distance of the centre to the ray comes from the residual vector, which does not cancel (Haines et al.).
static inline floatv bvh_sphere(const PacketRays* rays, global const SphereRecord* sphere) {
  const float3 to = vload3(0, sphere->centre) - rays->origin;
  const floatv along = to.x * rays->x + to.y * rays->y + to.z * rays->z;
  const floatv x = to.x - along * rays->x, y = to.y - along * rays->y, z = to.z - along * rays->z;
  const floatv inside2 = sphere->radius * sphere->radius - (x * x + y * y + z * z);
  const floatv t = along - sqrt(max(inside2, (floatv)(0.0f)));
  return PICK(MASK(inside2 > 0.0f) & MASK(t > 0.0f), t, (floatv)(-1.0f));
}

// Distance of the flat patch a sphere stands for: the disc through its centre across its normal; the sphere's
// entry where it has none. Negative where the rays miss it.
static inline floatv bvh_patch(const PacketRays* rays, global const SphereRecord* sphere,
                               global const float* normal) {
  const floatv entry = bvh_sphere(rays, sphere);
  const float3 across = vload3(0, normal);
  if (!ANY(MASK(entry > 0.0f)) || dot(across, across) == 0.0f) return entry;
  const float3 to = vload3(0, sphere->centre) - rays->origin;
  const floatv t =
      dot(across, to) / (across.x * rays->x + across.y * rays->y + across.z * rays->z);  // NaN in the plane
  const floatv x = to.x - t * rays->x, y = to.y - t * rays->y, z = to.z - t * rays->z;
  const intv on = MASK(x * x + y * y + z * z < sphere->radius * sphere->radius) & MASK(t > 0.0f);
  return PICK(on & MASK(entry > 0.0f), t, (floatv)(-1.0f));
}

typedef struct PacketHit {
  floatv t_triangle, t_sphere;  // the limit where there is none
  uintv triangle, sphere;       // index in its array, BVH_EMPTY = none
} PacketHit;

// Nearest triangle and nearest sphere of every ray, each no farther than `limit` (negative: the lane is
// idle). A sphere's patch counts up to `slack` behind the nearest triangle; farther ones may be missed, and
// so may triangles behind the nearest patch.
static inline PacketHit bvh_nearest(const PacketRays* rays, global const BvhNode* nodes,
                                    global const TriangleRecord* triangles,
                                    global const SphereRecord* spheres, global const SphereSurface* surfaces,
                                    uint root, floatv limit, float slack) {
  PacketHit hit = {limit, limit, (uintv)(BVH_EMPTY), (uintv)(BVH_EMPTY)};
  floatv entered[BVH_STACK];
  uint stack[BVH_STACK];
  uint top = 0u, next = root;
  if (root == BVH_EMPTY) return hit;
  floatv bound = limit;
  for (;;) {
    if (next & BVH_LEAF) {
      const uint first = next & BVH_FIRST_MASK;
      const uint end = first + ((next >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1u;
      if (next & BVH_SPHERES) {
        for (uint i = first; i < end; ++i) {
          const floatv t = bvh_patch(rays, spheres + i, surfaces[i].normal);
          const intv closer = MASK(t > 0.0f) & (MASK(t < hit.t_sphere) |
                                                (MASK(t == hit.t_sphere) & MASK((uintv)(i) < hit.sphere)));
          hit.t_sphere = PICK(closer, t, hit.t_sphere);
          hit.sphere = PICK(closer, (uintv)(i), hit.sphere);
        }
      } else {
        for (uint i = first; i < end; ++i) {
          const floatv t = bvh_triangle(rays, triangles + i);
          const intv closer =
              MASK(t > 0.0f) &
              (MASK(t < hit.t_triangle) | (MASK(t == hit.t_triangle) & MASK((uintv)(i) < hit.triangle)));
          hit.t_triangle = PICK(closer, t, hit.t_triangle);
          hit.triangle = PICK(closer, (uintv)(i), hit.triangle);
        }
      }
      bound = min(hit.t_sphere, hit.t_triangle + slack);
    } else {
      global const BvhNode* node = nodes + next;
      const floatv enter0 = bvh_enter(rays, node->low0, node->high0, bound);
      const floatv enter1 = bvh_enter(rays, node->low1, node->high1, bound);
      const int hit0 = ANY(MASK(enter0 < INFINITY)), hit1 = ANY(MASK(enter1 < INFINITY));
      if (hit0 && hit1) {
        const int second_first = ANY(MASK(enter1 < enter0)) && !ANY(MASK(enter0 < enter1));
        stack[top] = second_first ? node->child0 : node->child1;
        entered[top++] = second_first ? enter0 : enter1;
        next = second_first ? node->child1 : node->child0;
        continue;
      }
      if (hit0 || hit1) {
        next = hit0 ? node->child0 : node->child1;
        continue;
      }
    }
    do {
      if (top == 0u) return hit;
      --top;
    } while (!ANY(MASK(entered[top] <= bound)));
    next = stack[top];
  }
}

// Which of the `asked` rays meet a triangle nearer than far_triangle or a sphere nearer than far_sphere less
// two of the sphere's own radii: spheres bulge out of the surface they stand for, and large ones must not
// shade small neighbours.
static inline intv bvh_occluded(const PacketRays* rays, global const BvhNode* nodes,
                                global const TriangleRecord* triangles, global const SphereRecord* spheres,
                                uint root, floatv far_triangle, floatv far_sphere, intv asked) {
  uint stack[BVH_STACK];
  uint top = 0u, next = root;
  intv blocked = (intv)(0);
  if (root == BVH_EMPTY) return blocked;
  const floatv far = max(far_triangle, far_sphere);
  floatv bound = PICK(asked, far, (floatv)(-1.0f));
  for (;;) {
    if (next & BVH_LEAF) {
      const uint first = next & BVH_FIRST_MASK;
      const uint end = first + ((next >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1u;
      if (next & BVH_SPHERES) {
        for (uint i = first; i < end; ++i) {
          const floatv t = bvh_sphere(rays, spheres + i);
          blocked |= asked & MASK(t > 0.0f) & MASK(t < far_sphere - 2.0f * spheres[i].radius);
        }
      } else {
        for (uint i = first; i < end; ++i) {
          const floatv t = bvh_triangle(rays, triangles + i);
          blocked |= asked & MASK(t > 0.0f) & MASK(t < far_triangle);
        }
      }
      bound = PICK(blocked, (floatv)(-1.0f), bound);
      if (!ANY(asked & ~blocked)) return blocked;
    } else {
      global const BvhNode* node = nodes + next;
      const int hit0 = ANY(MASK(bvh_enter(rays, node->low0, node->high0, bound) < INFINITY));
      const int hit1 = ANY(MASK(bvh_enter(rays, node->low1, node->high1, bound) < INFINITY));
      if (hit0 && hit1) stack[top++] = node->child1;
      if (hit0 || hit1) {
        next = hit0 ? node->child0 : node->child1;
        continue;
      }
    }
    if (top == 0u) return blocked;
    next = stack[--top];
  }
}

#endif
