// Which rays of a packet something hides.
#ifndef HYBRID_LIB_BVH_SHADOWS_H
#define HYBRID_LIB_BVH_SHADOWS_H
#include "lib/bvh.h"

// Rays that differ by more share only what they fetch: 4 x 4 points that do not lie on one surface.
#define BVH_APART_SHADOWS 0.01f

// Which rays enter the sphere before `far` less two of its radii: as bvh_sphere, but for the root.
static inline intv bvh_shades(const PacketRays* rays, global const SphereRecord* sphere, floatv far) {
  const float3 to = vload3(0, sphere->centre) - rays->origin;
  const floatv along = to.x * rays->x + to.y * rays->y + to.z * rays->z;
  const floatv x = to.x - along * rays->x, y = to.y - along * rays->y, z = to.z - along * rays->z;
  const floatv inside2 = sphere->radius * sphere->radius - (x * x + y * y + z * z);
  const floatv past = along - (far - 2.0f * sphere->radius);
  return MASK(inside2 > 0.0f) & MASK(along > 0.0f) & MASK(along * along > inside2) &
         (MASK(past < 0.0f) | MASK(past * past < inside2));
}

// A packet's rays one by one; bit k of a mask is lane k.
typedef struct ApartRays {
  float x[VW], y[VW], z[VW], inverse_x[VW], inverse_y[VW], inverse_z[VW];
  float far[VW], bound[VW];  // for spheres; for anything
} ApartRays;

// Which of the rays `open`, whose directions have the same signs, are hidden: each node and leaf is fetched
// once, and tested with one ray after the other of those that reach it.
static inline uint bvh_hidden_one_way(const PacketRays* rays, const ApartRays* apart,
                                      global const BvhNode* nodes, global const TriangleRecord* triangles,
                                      global const SphereRecord* spheres, uint root, floatv far_triangle,
                                      uint open) {
  const uint asked = open, first_lane = lowest_bit(open);
  const int back_x = apart->inverse_x[first_lane] < 0.0f, back_y = apart->inverse_y[first_lane] < 0.0f,
            back_z = apart->inverse_z[first_lane] < 0.0f;
  uint codes[BVH_STACK], reach[BVH_STACK];  // per subtree to visit, the rays that enter it
  uint top = 0u;
  codes[top] = root, reach[top++] = open;
  while (top != 0u) {
    const uint next = codes[--top];
    uint left = reach[top] & open;
    if (left == 0u) continue;
    if (!(next & BVH_LEAF)) {
      global const BvhNode* node = nodes + next;
      const float16 near_x = vload16(0, back_x ? node->high_x : node->low_x) - rays->origin.x,
                    near_y = vload16(0, back_y ? node->high_y : node->low_y) - rays->origin.y,
                    near_z = vload16(0, back_z ? node->high_z : node->low_z) - rays->origin.z,
                    far_x = vload16(0, back_x ? node->low_x : node->high_x) - rays->origin.x,
                    far_y = vload16(0, back_y ? node->low_y : node->high_y) - rays->origin.y,
                    far_z = vload16(0, back_z ? node->low_z : node->high_z) - rays->origin.z;
      int16 entered = (int16)(0);  // per child
      for (; left != 0u; left &= left - 1u) {
        const uint lane = lowest_bit(left);
        const float16 near = max(max(near_x * apart->inverse_x[lane], near_y * apart->inverse_y[lane]),
                                 max(near_z * apart->inverse_z[lane], (float16)(0.0f)));
        const float16 exit = min(min(far_x * apart->inverse_x[lane], far_y * apart->inverse_y[lane]),
                                 far_z * apart->inverse_z[lane]) *
                             1.0000005f;
        entered |= (near <= min(exit, (float16)(apart->bound[lane]))) & (int)(1u << lane);
      }
      uint by_child[BVH_WIDTH];
      vstore16(as_uint16(entered), 0, by_child);
      // The first child on top: splats and faces in the order of the tree hide soonest, as measured.
      for (uint among = bits_of(entered != 0); among != 0u;) {
        const uint child = 31u - clz(among);
        among &= ~(1u << child);
        codes[top] = node->child[child], reach[top++] = by_child[child];
      }
    } else if (next & BVH_SPHERES) {
      const BvhSpheres to = bvh_spheres(rays->origin, spheres + (next & BVH_FIRST_MASK));
      for (; left != 0u; left &= left - 1u) {
        const uint lane = lowest_bit(left);
        const float8 along = to.x * apart->x[lane] + to.y * apart->y[lane] + to.z * apart->z[lane];
        const float8 off_x = to.x - along * apart->x[lane], off_y = to.y - along * apart->y[lane],
                     off_z = to.z - along * apart->z[lane];
        const float8 inside2 = to.radius * to.radius - (off_x * off_x + off_y * off_y + off_z * off_z);
        const float8 past = along - (apart->far[lane] - 2.0f * to.radius);
        const int8 hit = (inside2 > 0.0f) & (along > 0.0f) & (along * along > inside2) &
                         ((past < 0.0f) | (past * past < inside2));
        if ((bits_of_8(hit) & bvh_full(next)) != 0u) open &= ~(1u << lane);
      }
    } else {
      const uint first = next & BVH_FIRST_MASK;
      const uint end = first + bvh_count(next);
      int one[VW];
      for (uint i = first; i < end; ++i) {
        const floatv t = bvh_triangle(rays, triangles + i);
        const intv blocked = MASK(t > 0.0f) & MASK(t < far_triangle);
        if (!ANY(blocked)) continue;
        STORE_LANES(blocked, one);
        for (uint lane = 0u; lane < VW; ++lane) open &= ~((uint)(one[lane] & 1) << lane);
      }
    }
  }
  return asked & ~open;
}

// bvh_occluded for rays that have little in common.
static inline intv bvh_occluded_apart(const PacketRays* rays, global const BvhNode* nodes,
                                      global const TriangleRecord* triangles,
                                      global const SphereRecord* spheres, uint root, floatv far_triangle,
                                      floatv far_sphere, intv asked) {
  ApartRays apart;
  int one[VW];
  STORE_LANES(rays->x, apart.x);
  STORE_LANES(rays->y, apart.y);
  STORE_LANES(rays->z, apart.z);
  STORE_LANES(rays->inverse_x, apart.inverse_x);
  STORE_LANES(rays->inverse_y, apart.inverse_y);
  STORE_LANES(rays->inverse_z, apart.inverse_z);
  STORE_LANES(far_sphere, apart.far);
  STORE_LANES(max(far_triangle, far_sphere), apart.bound);
  // 0 for what is not asked, else which signs: 1 to 8.
  STORE_LANES(asked, one);
  for (uint lane = 0u; lane < VW; ++lane)
    if (one[lane] != 0)
      one[lane] = 1 + (apart.inverse_x[lane] < 0.0f) + 2 * (apart.inverse_y[lane] < 0.0f) +
                  4 * (apart.inverse_z[lane] < 0.0f);
  uint hidden = 0u;
  for (uint left = (1u << VW) - 1u; left != 0u;) {
    const int signs = one[lowest_bit(left)];
    uint same = 0u;
    for (uint lane = 0u; lane < VW; ++lane) same |= (uint)(one[lane] == signs) << lane;
    left &= ~same;
    if (signs != 0)
      hidden |= bvh_hidden_one_way(rays, &apart, nodes, triangles, spheres, root, far_triangle, same);
  }
  for (uint lane = 0u; lane < VW; ++lane) one[lane] = -(int)((hidden >> lane) & 1u);
  return LOAD_LANES(one);
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
  if (VW > 1 && rays->spread > BVH_APART_SHADOWS)
    return bvh_occluded_apart(rays, nodes, triangles, spheres, root, far_triangle, far_sphere, asked);
  const floatv far = max(far_triangle, far_sphere);
  floatv bound = PICK(asked, far, (floatv)(-1.0f));
  float farthest = MOST_LANE(bound), sphere_bound = MOST_LANE(PICK(asked, far_sphere, (floatv)(-1.0f)));
  for (;;) {
    if (next & BVH_LEAF) {
      const uint first = next & BVH_FIRST_MASK;
      const uint end = first + bvh_count(next);
      if (next & BVH_SPHERES) {
        uint among = bvh_spheres_among(rays, spheres + first, next, sphere_bound, 2.0f);
        for (; among != 0u; among &= among - 1u) {
          const uint i = first + lowest_bit(among);
          blocked |= asked & bvh_shades(rays, spheres + i, far_sphere);
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
      for (; among != 0u; among &= among - 1u) stack[top++] = node->child[lowest_bit(among)];
    }
    if (top == 0u) return blocked;
    next = stack[--top];
  }
}

#endif
