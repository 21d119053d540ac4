// Closest point on the model's triangles as closest_point.cl has it, bit for bit, by a tree of boxes: for
// models of more than a few hundred triangles (METHOD 6).
// Mapping: one work-item per RUN packets of VW queries, one query per lane; the lanes go through the tree
// together, so that neighbouring queries should be near each other, as samples in scan order are: a packet
// tries first what the one before it found. A child is entered when one lane's best is no nearer than the
// child's box, and one of its normals may be compatible.
// in:  queries as in closest_point.cl; triangles [params.triangles] local frame, in the order of the leaves;
//      nodes: the tree (shared/proxy_tree_records.h).
//      Boxes contain their triangles with a margin for what the plane test may round off (proxy_tree.cpp).
// out: as closest_point.cl has it.
// params: params_closest_point.h, `root` too. defines: VW lanes, RUN packets.
// edges: an empty tree -> all NaN; of equal distances the lowest triangle index wins.
// cost: per query 24 bytes read and 24 written; per packet and node entered 2 boxes of about 40 flops a lane.
// reference twin: tests/reference/closest_point_tree.cpp
#include "lib/closest_triangle.h"
#include "shared/proxy_tree_records.h"

#ifndef RUN
#define RUN 1
#endif

#if VW == 1
#define FIRST_LANE(value) (value)
#else
#define FIRST_LANE(value) ((value).s0)
#endif

// Squared distances are shrunk by more than the rounding of those they are compared with.
#define SHRINK 0.9999f

static inline floatv box_distance2(global const float* low, global const float* high, const Query* q) {
  const floatv zero = 0.0f;
  const floatv x = max(max(low[0] - q->x, q->x - high[0]), zero);
  const floatv y = max(max(low[1] - q->y, q->y - high[1]), zero);
  const floatv z = max(max(low[2] - q->z, q->z - high[2]), zero);
  return SHRINK * (x * x + y * y + z * z);
}

// Whether a normal inside the span may be compatible: least and greatest component along x, y, z in 5 bits
// each, -1 to 1.
static inline intv may_face(uint span, const Query* q, float min_facing) {
  float bound[6];
  for (uint k = 0; k < 6u; ++k) bound[k] = (float)((span >> (5u * k)) & 31u) * (2.0f / 31.0f) - 1.0f;
  return !(max(q->nx * bound[0], q->nx * bound[1]) + max(q->ny * bound[2], q->ny * bound[3]) +
               max(q->nz * bound[4], q->nz * bound[5]) <
           min_facing);
}

// Makes `best` the closest of all triangles that are nearer than it is; `before`: the one to try first, or
// NO_TRIANGLE.
static inline void find_closest(const ClosestPointParams* params, const Query* query,
                                global const ProxyTriangle* triangles, global const ProxyNode* nodes,
                                uint before, Best* best) {
  const int oriented = params->min_facing > -INFINITY;
  if (before != NO_TRIANGLE) try_facing(best, before, triangles + before, query, params->min_facing);

  uint stack[PROXY_TREE_STACK];
  floatv reach[PROXY_TREE_STACK];
  uint top = 0u, next = params->root;
  while (next != BVH_EMPTY) {
    if (next & BVH_LEAF) {
      const uint begin = next & BVH_FIRST_MASK;
      const uint end = begin + ((next >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1u;
      for (uint i = begin; i < end; ++i) try_facing(best, i, triangles + i, query, params->min_facing);
    } else {
      global const ProxyNode* node = nodes + next;
      const floatv d0 = box_distance2(node->low0, node->high0, query);
      const floatv d1 = box_distance2(node->low1, node->high1, query);
      intv open0 = d0 <= best->distance2, open1 = d1 <= best->distance2;
      if (oriented) {
        open0 &= may_face(node->span0, query, params->min_facing);
        open1 &= may_face(node->span1, query, params->min_facing);
      }
      const int enter0 = ANY(open0), enter1 = ANY(open1);
      if (enter0 && enter1) {
        const int second_first = FIRST_LANE(d1) < FIRST_LANE(d0);
        stack[top] = second_first ? node->child0 : node->child1;
        reach[top++] = second_first ? d0 : d1;
        next = second_first ? node->child1 : node->child0;
        continue;
      }
      if (enter0 || enter1) {
        next = enter0 ? node->child0 : node->child1;
        continue;
      }
    }
    do {
      next = top == 0u ? BVH_EMPTY : stack[--top];
    } while (next != BVH_EMPTY && !ANY(reach[top] <= best->distance2));
  }
}

kernel void closest_point_tree(ClosestPointParams params, global const float* restrict x,
                               global const float* restrict y, global const float* restrict z,
                               global const float* restrict nx, global const float* restrict ny,
                               global const float* restrict nz,
                               global const ProxyTriangle* restrict triangles,
                               global const ProxyNode* restrict nodes, global float* restrict distance,
                               global float* restrict height, global uint* restrict triangle,
                               global float* restrict near_x, global float* restrict near_y,
                               global float* restrict near_z) {
  const uint begin = (uint)get_global_id(0) * (VW * RUN);
  const uint end = min(begin + VW * RUN, params.queries);
  uint before = NO_TRIANGLE;
  for (uint first = begin; first < end; first += VW) {
    Query query;
    load_queries(&params, first, x, y, z, nx, ny, nz, &query);
    Best best;
    begin_search(params.gate2, &best);
    // A NaN query looks for nothing.
    best.distance2 =
        select(best.distance2, (floatv)(-1.0f), query.x + query.y + query.z != query.x + query.y + query.z);
    find_closest(&params, &query, triangles, nodes, before, &best);
    before = FIRST_LANE(best.triangle);
    store_closest(&best, &query, first, params.queries, distance, height, triangle, near_x, near_y, near_z);
  }
}
