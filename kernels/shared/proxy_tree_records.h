// The tree of boxes over the model's triangles as closest_point_tree sees it, built by
// host/stages/registration/proxy_tree.cpp. Children are coded as in shared/bvh_records.h; metres, local
// frame.
#ifndef HYBRID_SHARED_PROXY_TREE_RECORDS_H
#define HYBRID_SHARED_PROXY_TREE_RECORDS_H
#include "shared/bvh_records.h"

// Entries of the traversal's stack: a binary node leaves one pending.
#define PROXY_TREE_STACK 64

// The boxes of both children, so that one fetch decides both, and what their triangles' normals span: least
// and greatest component along x, y and z in 5 bits each, -1 to 1.
typedef struct ProxyNode {
  float low0[3], high0[3];
  float low1[3], high1[3];
  HYBRID_UINT child0, child1;
  HYBRID_UINT span0, span1;
} ProxyNode;
LAYOUT_CHECK(ProxyNode, 64);

#endif
