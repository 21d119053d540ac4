// The nearest triangle and sphere along a packet's rays.
#ifndef HYBRID_LIB_BVH_NEAREST_H
#define HYBRID_LIB_BVH_NEAREST_H
#include "lib/bvh.h"

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
      const uint end = first + bvh_count(next);
      if (next & BVH_SPHERES) {
        FETCH(surfaces + first);
        FETCH(surfaces + first + BVH_LARGEST_LEAF / 2);
        uint among = bvh_spheres_among(rays, spheres + first, next, farthest, 0.0f);
        for (; among != 0u; among &= among - 1u) {
          const uint i = first + lowest_bit(among);
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
      if (!rays->apart && popcount(among) == 1u) {
        next = node->child[lowest_bit(among)];
        continue;
      }
      for (; among != 0u; among &= among - 1u) {
        const uint child = lowest_bit(among);
        if (rays->apart && !ANY(bvh_enters(rays, node, child, bound))) continue;
        uint place = top++;  // the nearest on top
        for (; place > before && entered[place - 1u] < entries[child]; --place) {
          entered[place] = entered[place - 1u];
          stack[place] = stack[place - 1u];
        }
        entered[place] = entries[child];
        const uint code = node->child[child];
        stack[place] = code;
        if (code >= (BVH_LEAF | BVH_SPHERES)) {
          FETCH(spheres + (code & BVH_FIRST_MASK));
          FETCH(spheres + (code & BVH_FIRST_MASK) + BVH_LARGEST_LEAF / 2);
        }
      }
    }
    do {
      if (top == 0u) return hit;
      --top;
    } while (!(entered[top] <= farthest));
    next = stack[top];
  }
}

#endif
