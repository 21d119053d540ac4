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
  float3 axis;   // unit, amid the rays in use; they differ from it by at most `wide`
  float wide;    // no number when the rays lie all around
  float spread;  // of the directions: their largest difference along an axis
  int apart;     // so far from each other that a box among them may be missed by all
} PacketRays;

// Packets whose directions differ by more test each box with each ray, too. 4 x 4 pixels of a view 300 pixels
// wide are this far apart; larger values make rays of wide lists slower, smaller ones small pictures.
#define BVH_APART 0.05f
// Shadow rays that differ by more go one by one: 4 x 4 points that do not lie on one surface.
#define BVH_APART_SHADOWS 0.01f

// A direction's component, moved away from 0 so that its inverse times any distance stays finite.
static inline floatv bvh_inverse(floatv d) {
  const floatv tiny = PICK(MASK(d < 0.0f), (floatv)(-1e-18f), (floatv)(1e-18f));
  return 1.0f / PICK(MASK(fabs(d) < 1e-18f), tiny, d);
}

// Rays of the lanes `used`, of which there is at least one.
static inline PacketRays bvh_rays(float3 origin, floatv x, floatv y, floatv z, intv used) {
  PacketRays rays;
  rays.origin = origin;
  rays.x = x, rays.y = y, rays.z = z;
  rays.inverse_x = bvh_inverse(x), rays.inverse_y = bvh_inverse(y), rays.inverse_z = bvh_inverse(z);
  const floatv above = (floatv)(2.0f), below = (floatv)(-2.0f);
  const float3 low = (float3)(LEAST_LANE(PICK(used, x, above)), LEAST_LANE(PICK(used, y, above)),
                              LEAST_LANE(PICK(used, z, above)));
  const float3 high = (float3)(MOST_LANE(PICK(used, x, below)), MOST_LANE(PICK(used, y, below)),
                               MOST_LANE(PICK(used, z, below)));
  // The inverse falls from -0 to -inf and from inf to 0, so it is least above 0 where the direction is
  // highest.
  const float3 none = (float3)(0.0f), tiny = (float3)(1e-18f), huge = (float3)(2e18f);
  rays.least_above = select(none, 1.0f / max(high, tiny), high >= 0.0f);
  rays.most_above = select(none, select(huge, 1.0f / max(low, tiny), low > 0.0f), high >= 0.0f);
  rays.least_below = select(none, 1.0f / min(low, -tiny), low < 0.0f);
  rays.most_below = select(none, select(-huge, 1.0f / min(high, -tiny), high < 0.0f), low < 0.0f);
  rays.spread = max(max(high.x - low.x, high.y - low.y), high.z - low.z);
  rays.apart = VW > 1 && rays.spread > BVH_APART;
  const float3 middle = 0.5f * (low + high);
  const float length_of_middle = length(middle);
  rays.axis = middle / length_of_middle;
  rays.wide = 0.5f * length(high - low) + (1.0f - length_of_middle);
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
  return bits_of((near <= min(far * 1.0000005f, (float16)(bound))) & (far > 0.0f));
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
// entry where it has none. Negative where the rays miss it or begin inside the sphere.
static inline floatv bvh_patch(const PacketRays* rays, global const SphereRecord* sphere,
                               global const float* normal) {
  const float3 across = vload3(0, normal);
  if (dot(across, across) == 0.0f) return bvh_sphere(rays, sphere);
  const float3 to = vload3(0, sphere->centre) - rays->origin;
  const float radius2 = sphere->radius * sphere->radius;
  if (!(dot(to, to) > radius2)) return (floatv)(-1.0f);
  const floatv t =
      dot(across, to) / (across.x * rays->x + across.y * rays->y + across.z * rays->z);  // NaN in the plane
  const floatv x = to.x - t * rays->x, y = to.y - t * rays->y, z = to.z - t * rays->z;
  const intv on = MASK(x * x + y * y + z * z < radius2) & MASK(t > 0.0f);
  return PICK(on, t, (floatv)(-1.0f));
}

static inline uint bvh_count(uint leaf) {
  return ((leaf >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1u;
}

// A bit for each of a leaf's primitives.
static inline uint bvh_full(uint leaf) {
  return (2u << (bvh_count(leaf) - 1u)) - 1u;
}

// The spheres of a leaf, eight at once, whatever follows those of the leaf.
typedef struct BvhSpheres {
  float8 x, y, z, radius;  // centres as seen from the rays' origin
} BvhSpheres;

static inline BvhSpheres bvh_spheres(float3 origin, global const SphereRecord* first) {
  const float16 a = vload16(0, (global const float*)first), b = vload16(1, (global const float*)first);
  const BvhSpheres out = {(float8)(a.s048c, b.s048c) - origin.x, (float8)(a.s159d, b.s159d) - origin.y,
                          (float8)(a.s26ae, b.s26ae) - origin.z, (float8)(a.s37bf, b.s37bf)};
  return out;
}

// Which of a leaf's spheres lie in the cone around all rays and may be entered before `bound` less `radii` of
// theirs, one bit each; it may say yes where each ray misses, and allows for rounding.
static inline uint bvh_spheres_among(const PacketRays* rays, global const SphereRecord* first, uint leaf,
                                     float bound, float radii) {
  if (VW == 1 || rays->apart) return bvh_full(leaf);
  const BvhSpheres to = bvh_spheres(rays->origin, first);
  const float8 along = to.x * rays->axis.x + to.y * rays->axis.y + to.z * rays->axis.z;
  const float8 x = to.x - along * rays->axis.x, y = to.y - along * rays->axis.y,
               z = to.z - along * rays->axis.z;
  const float8 off = sqrt(x * x + y * y + z * z), size = fabs(along) + off + to.radius;
  const float8 wide = to.radius + size * (rays->wide * 1.001f + 1e-6f);
  const float8 entry = along - to.radius - 1e-6f * size;
  return bits_of_8((off <= wide) & (entry <= bound - radii * to.radius)) & bvh_full(leaf);
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

// bvh_occluded for rays that have little in common: each node and leaf is fetched once, and tested with one
// ray after the other of those that reach it. Bit k of a mask is lane k.
static inline intv bvh_occluded_apart(const PacketRays* rays, global const BvhNode* nodes,
                                      global const TriangleRecord* triangles,
                                      global const SphereRecord* spheres, uint root, floatv far_triangle,
                                      floatv far_sphere, intv asked) {
  uint codes[BVH_STACK], reach[BVH_STACK];  // per subtree to visit, the rays that enter it
  float x[VW], y[VW], z[VW], inverse_x[VW], inverse_y[VW], inverse_z[VW], far[VW], bound[VW];
  int one[VW];
  STORE_LANES(rays->x, x);
  STORE_LANES(rays->y, y);
  STORE_LANES(rays->z, z);
  STORE_LANES(rays->inverse_x, inverse_x);
  STORE_LANES(rays->inverse_y, inverse_y);
  STORE_LANES(rays->inverse_z, inverse_z);
  STORE_LANES(far_sphere, far);
  STORE_LANES(max(far_triangle, far_sphere), bound);
  STORE_LANES(asked, one);
  uint open = 0u;
  for (uint lane = 0u; lane < VW; ++lane) open |= (uint)(one[lane] & 1) << lane;
  const uint all = open;
  uint top = 0u;
  codes[top] = root, reach[top++] = open;
  while (top != 0u) {
    const uint next = codes[--top];
    uint left = reach[top] & open;
    if (left == 0u) continue;
    if (!(next & BVH_LEAF)) {
      global const BvhNode* node = nodes + next;
      const float16 low_x = vload16(0, node->low_x) - rays->origin.x,
                    low_y = vload16(0, node->low_y) - rays->origin.y,
                    low_z = vload16(0, node->low_z) - rays->origin.z,
                    high_x = vload16(0, node->high_x) - rays->origin.x,
                    high_y = vload16(0, node->high_y) - rays->origin.y,
                    high_z = vload16(0, node->high_z) - rays->origin.z;
      int16 entered = (int16)(0);  // per child
      for (; left != 0u; left &= left - 1u) {
        const uint lane = lowest_bit(left);
        const float16 x0 = low_x * inverse_x[lane], x1 = high_x * inverse_x[lane];
        const float16 y0 = low_y * inverse_y[lane], y1 = high_y * inverse_y[lane];
        const float16 z0 = low_z * inverse_z[lane], z1 = high_z * inverse_z[lane];
        const float16 near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), (float16)(0.0f)));
        const float16 exit = min(min(max(x0, x1), max(y0, y1)), max(z0, z1)) * 1.0000005f;
        entered |= (near <= min(exit, (float16)(bound[lane]))) & (int)(1u << lane);
      }
      uint by_child[BVH_WIDTH];
      vstore16(as_uint16(entered), 0, by_child);
      for (uint among = bits_of((entered != 0) & (low_x <= high_x)); among != 0u; among &= among - 1u) {
        const uint child = lowest_bit(among);
        codes[top] = node->child[child], reach[top++] = by_child[child];
      }
    } else if (next & BVH_SPHERES) {
      const BvhSpheres to = bvh_spheres(rays->origin, spheres + (next & BVH_FIRST_MASK));
      for (; left != 0u; left &= left - 1u) {
        const uint lane = lowest_bit(left);
        const float8 along = to.x * x[lane] + to.y * y[lane] + to.z * z[lane];
        const float8 off_x = to.x - along * x[lane], off_y = to.y - along * y[lane],
                     off_z = to.z - along * z[lane];
        const float8 inside2 = to.radius * to.radius - (off_x * off_x + off_y * off_y + off_z * off_z);
        const float8 past = along - (far[lane] - 2.0f * to.radius);
        const int8 hit = (inside2 > 0.0f) & (along > 0.0f) & (along * along > inside2) &
                         ((past < 0.0f) | (past * past < inside2));
        if ((bits_of_8(hit) & bvh_full(next)) != 0u) open &= ~(1u << lane);
      }
    } else {
      const uint first = next & BVH_FIRST_MASK;
      const uint end = first + bvh_count(next);
      for (uint i = first; i < end; ++i) {
        const floatv t = bvh_triangle(rays, triangles + i);
        const intv blocked = MASK(t > 0.0f) & MASK(t < far_triangle);
        if (!ANY(blocked)) continue;
        STORE_LANES(blocked, one);
        for (uint lane = 0u; lane < VW; ++lane) open &= ~((uint)(one[lane] & 1) << lane);
      }
    }
  }
  for (uint lane = 0u; lane < VW; ++lane) one[lane] = -(int)(((all & ~open) >> lane) & 1u);
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
      for (; among != 0u; among &= among - 1u) {
        const uint child = lowest_bit(among);
        if (!rays->apart || ANY(bvh_enters(rays, node, child, bound))) stack[top++] = node->child[child];
      }
    }
    if (top == 0u) return blocked;
    next = stack[--top];
  }
}

#endif
