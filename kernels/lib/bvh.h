// Rays of one origin and the tree of triangles and spheres (shared/bvh_records.h), VW rays at a time: its
// boxes and its primitives. How rays go through it: lib/bvh_nearest.h, lib/bvh_shadows.h.
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
__attribute__((always_inline)) static inline floatv bvh_triangle(const PacketRays* rays,
                                                                 global const TriangleRecord* triangle) {
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

#endif
