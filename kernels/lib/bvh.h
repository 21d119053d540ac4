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
  // What the inverses of the lanes in use lie between, apart for those above and below 0; 0: there are none.
  float3 least_above, most_above, least_below, most_below;
  int apart;  // so far from each other that a box among them may be missed by all
} PacketRays;

// Packets whose directions differ by more test each box with each ray, too. 4 x 4 pixels of a view 300 pixels
// wide are this far apart; larger values make rays of wide lists slower, smaller ones small pictures.
#define BVH_APART 0.05f

// A direction's component, moved away from 0 so that its inverse times any distance stays finite.
static inline floatv bvh_inverse(floatv d) {
  const floatv tiny = PICK(MASK(d < 0.0f), (floatv)(-1e-18f), (floatv)(1e-18f));
  return 1.0f / PICK(MASK(fabs(d) < 1e-18f), tiny, d);
}

// The inverses above 0 lie between *least and *most; the same, of the negated inverses, gives those below.
static inline void bvh_between(floatv inverse, intv used, float* least, float* most) {
  const intv counts = used & MASK(inverse > 0.0f);
  *most = MOST_LANE(PICK(counts, inverse, (floatv)(0.0f)));
  *least = *most > 0.0f ? LEAST_LANE(PICK(counts, inverse, (floatv)(INFINITY))) : 0.0f;
}

static inline float bvh_spread(floatv d, intv used) {
  return MOST_LANE(PICK(used, d, (floatv)(-2.0f))) - LEAST_LANE(PICK(used, d, (floatv)(2.0f)));
}

// Rays of the lanes `used`, of which there is at least one.
static inline PacketRays bvh_rays(float3 origin, floatv x, floatv y, floatv z, intv used) {
  PacketRays rays;
  rays.origin = origin;
  rays.x = x, rays.y = y, rays.z = z;
  rays.inverse_x = bvh_inverse(x), rays.inverse_y = bvh_inverse(y), rays.inverse_z = bvh_inverse(z);
  float least[6], most[6];
  bvh_between(rays.inverse_x, used, least, most);
  bvh_between(rays.inverse_y, used, least + 1, most + 1);
  bvh_between(rays.inverse_z, used, least + 2, most + 2);
  bvh_between(-rays.inverse_x, used, least + 3, most + 3);
  bvh_between(-rays.inverse_y, used, least + 4, most + 4);
  bvh_between(-rays.inverse_z, used, least + 5, most + 5);
  rays.least_above = vload3(0, least), rays.most_above = vload3(0, most);
  rays.least_below = -vload3(1, least), rays.most_below = -vload3(1, most);
  rays.apart = VW > 1 && max(max(bvh_spread(x, used), bvh_spread(y, used)), bvh_spread(z, used)) > BVH_APART;
  return rays;
}

// Which of a node's boxes lie among the packet's rays nearer than `bound`, one bit each, and the distances at
// which the first ray may enter them. All rays lie between the extremes of their inverses, so this asks once
// for all of them (interval arithmetic: Boulos, Wald, Shirley 2006); it may say yes where each ray misses.
static inline uint bvh_children(const PacketRays* rays, global const BvhNode* node, float bound,
                                float* entries) {
  float16 near = (float16)(0.0f), far = (float16)(INFINITY), low, high;
#define BVH_SLAB(axis)                                                                \
  low = vload16(0, node->low_##axis) - rays->origin.axis;                             \
  high = vload16(0, node->high_##axis) - rays->origin.axis;                           \
  near = max(near, max(low * rays->least_above.axis, high * rays->least_below.axis)); \
  far = min(far, max(high * rays->most_above.axis, low * rays->most_below.axis));
  BVH_SLAB(x)
  BVH_SLAB(y)
  BVH_SLAB(z)
#undef BVH_SLAB
  vstore16(near, 0, entries);
  const int16 bit = (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
  return bits_of((near <= min(far * 1.0000005f, (float16)(bound))) & (far > 0.0f) & bit);
}

// Which rays enter a child's box before `bound`. The exit is widened by two roundings (Ize 2013), here and
// above, so that a box never hides what lies in it.
static inline intv bvh_enters(const PacketRays* rays, global const BvhNode* node, uint child, floatv bound) {
  const floatv x0 = (node->low_x[child] - rays->origin.x) * rays->inverse_x;
  const floatv x1 = (node->high_x[child] - rays->origin.x) * rays->inverse_x;
  const floatv y0 = (node->low_y[child] - rays->origin.y) * rays->inverse_y;
  const floatv y1 = (node->high_y[child] - rays->origin.y) * rays->inverse_y;
  const floatv z0 = (node->low_z[child] - rays->origin.z) * rays->inverse_z;
  const floatv z1 = (node->high_z[child] - rays->origin.z) * rays->inverse_z;
  const floatv near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), (floatv)(0.0f)));
  const floatv far = min(min(max(x0, x1), max(y0, y1)), max(z0, z1)) * 1.0000005f;
  return MASK(near <= min(far, bound));
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
  float entered[BVH_STACK], entries[BVH_WIDTH];
  uint stack[BVH_STACK];
  uint top = 0u, next = root;
  if (root == BVH_EMPTY) return hit;
  floatv bound = limit;
  float farthest = MOST_LANE(bound);
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
      farthest = MOST_LANE(bound);
    } else {
      global const BvhNode* node = nodes + next;
      uint among = bvh_children(rays, node, farthest, entries);
      const uint before = top;
      for (; among != 0u; among &= among - 1u) {
        const uint child = 31u - clz(among & (0u - among));
        if (rays->apart && !ANY(bvh_enters(rays, node, child, bound))) continue;
        uint place = top++;  // the nearest on top
        for (; place > before && entered[place - 1u] < entries[child]; --place) {
          entered[place] = entered[place - 1u];
          stack[place] = stack[place - 1u];
        }
        entered[place] = entries[child];
        stack[place] = node->child[child];
      }
    }
    do {
      if (top == 0u) return hit;
      --top;
    } while (!(entered[top] <= farthest));
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
  float entries[BVH_WIDTH];
  uint top = 0u, next = root;
  intv blocked = (intv)(0);
  if (root == BVH_EMPTY) return blocked;
  const floatv far = max(far_triangle, far_sphere);
  floatv bound = PICK(asked, far, (floatv)(-1.0f));
  float farthest = MOST_LANE(bound);
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
      farthest = MOST_LANE(bound);
      if (!(farthest >= 0.0f)) return blocked;
    } else {
      global const BvhNode* node = nodes + next;
      uint among = bvh_children(rays, node, farthest, entries);
      for (; among != 0u; among &= among - 1u) {
        const uint child = 31u - clz(among & (0u - among));
        if (!rays->apart || ANY(bvh_enters(rays, node, child, bound))) stack[top++] = node->child[child];
      }
    }
    if (top == 0u) return blocked;
    next = stack[--top];
  }
}

#endif
