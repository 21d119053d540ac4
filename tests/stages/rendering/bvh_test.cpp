#include "stages/rendering/bvh.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>

#include "cases/ray_cast_case.hpp"
#include "device.hpp"
#include "stages/rendering/bvh_clusters.hpp"
#include "stages/rendering/bvh_collapse.hpp"
#include "stages/rendering/bvh_join.hpp"

namespace hybrid::testing::bvh_test {
namespace {

using stages::build_bvh;
using stages::Bvh;

struct Bounds {
  std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
};

// Checks that child boxes hold what is below them; counts primitives and the depth.
struct Walk {
  const Bvh& bvh;
  std::size_t triangles = 0, spheres = 0;
  int depth = 0, pending = 0, stack = 0;  // entries a traversal may leave, and the most of them

  Bounds visit(std::uint32_t code, int level) {
    depth = std::max(depth, level);
    Bounds bounds;
    const auto add = [&](const float* low, const float* high) {
      for (std::size_t k = 0; k < 3; ++k) {
        bounds.low[k] = std::min(bounds.low[k], low[k]);
        bounds.high[k] = std::max(bounds.high[k], high[k]);
      }
    };
    if (code & BVH_LEAF) {
      const std::size_t first = code & BVH_FIRST_MASK,
                        count = ((code >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1;
      for (std::size_t i = first; i < first + count; ++i) {
        if (code & BVH_SPHERES) {
          const auto& s = bvh.spheres.at(i);
          const float low[3] = {s.centre[0] - s.radius, s.centre[1] - s.radius, s.centre[2] - s.radius};
          const float high[3] = {s.centre[0] + s.radius, s.centre[1] + s.radius, s.centre[2] + s.radius};
          add(low, high);
          ++spheres;
        } else {
          const auto& t = bvh.triangles.at(i);
          add(t.a, t.a), add(t.b, t.b), add(t.c, t.c);
          ++triangles;
        }
      }
      return bounds;
    }
    const BvhNode& node = bvh.nodes.at(code);
    for (std::size_t i = 0; i < BVH_WIDTH; ++i) {
      if (node.child[i] == BVH_EMPTY) {
        EXPECT_EQ(node.low_x[i], BVH_NOWHERE);
        EXPECT_EQ(node.high_z[i], -BVH_NOWHERE);
        continue;
      }
      const int before = pending;
      pending += static_cast<int>(std::count_if(node.child, node.child + BVH_WIDTH,
                                                [](std::uint32_t c) { return c != BVH_EMPTY; })) -
                 1;
      stack = std::max(stack, pending);
      const Bounds child = visit(node.child[i], level + 1);
      pending = before;
      const float low[3] = {node.low_x[i], node.low_y[i], node.low_z[i]};
      const float high[3] = {node.high_x[i], node.high_y[i], node.high_z[i]};
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_LE(low[k], child.low[k]);
        EXPECT_GE(high[k], child.high[k]);
      }
      add(child.low.data(), child.high.data());
    }
    return bounds;
  }
};

void expect_sound(const Bvh& bvh, std::size_t triangles, std::size_t spheres) {
  Walk walk{bvh};
  if (bvh.root != BVH_EMPTY) walk.visit(bvh.root, 1);
  EXPECT_EQ(walk.triangles, triangles);
  EXPECT_EQ(walk.spheres, spheres);
  EXPECT_LT(walk.stack + 1, BVH_STACK);
  std::vector<std::uint32_t> sources = bvh.sphere_source;
  std::sort(sources.begin(), sources.end());
  EXPECT_EQ(sources.size(), spheres);
  for (std::size_t i = 0; i < sources.size(); ++i) ASSERT_EQ(sources[i], i);
}

}  // namespace

TEST(Bvh, holds_every_primitive_once_within_its_boxes) {
  for (const auto& [triangles, spheres] : {std::pair<std::size_t, std::size_t>{0, 0},
                                           {1, 0},
                                           {0, 1},
                                           {1, 1},
                                           {5, 3},
                                           {204, 0},
                                           {0, 5003},
                                           {997, 40009}}) {
    const RayScene scene = RayScene::make(triangles, spheres, 2);
    expect_sound(build_bvh(scene.triangles, scene.spheres), triangles, spheres);
  }
}

// Each of two trees keeps its own root and what lies below it; a third root has all.
TEST(Bvh, two_trees_lie_in_one_under_three_roots) {
  for (const auto& [triangles, spheres] :
       {std::pair<std::size_t, std::size_t>{0, 0}, {3, 0}, {0, 2}, {204, 5003}})
    for (const std::size_t more : {0, 1, 7, 900}) {
      const RayScene scene = RayScene::make(triangles, spheres, 2), beside = RayScene::make(more, 0, 3);
      const Bvh other = build_bvh(beside.triangles, {});
      Bvh bvh = build_bvh(scene.triangles, scene.spheres, other);
      const std::uint32_t own = bvh.root, others = stages::append_tree(other, bvh);
      expect_sound(bvh, triangles, spheres);
      const std::uint32_t both = stages::join_trees(own, others, bvh);
      for (const auto& [root, count, balls] : {std::tuple{own, triangles, spheres},
                                               {others, more, std::size_t{0}},
                                               {both, triangles + more, spheres}}) {
        Walk walk{bvh};
        if (root != BVH_EMPTY) walk.visit(root, 1);
        EXPECT_EQ(walk.triangles, count);
        EXPECT_EQ(walk.spheres, balls);
        EXPECT_LT(walk.stack + 1, BVH_STACK);
      }
    }
}

TEST(Bvh, survives_coincident_and_exponentially_spaced_primitives) {
  RayScene scene = RayScene::make(100, 100, 2);
  for (auto& triangle : scene.triangles) triangle = scene.triangles[0];
  for (auto& sphere : scene.spheres) sphere = {{scene.triangles[0].a[0], 0, 0}, 0.1f};
  expect_sound(build_bvh(scene.triangles, scene.spheres), 100, 100);
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    scene.spheres[i] = {{std::ldexp(1.0f, -static_cast<int>(i)), 0, 0},
                        std::ldexp(0.1f, -static_cast<int>(i))};
  expect_sound(build_bvh({}, scene.spheres), 0, 100);
}

// More in one place than a cluster of spheres holds, and clumps much smaller than a cell of the octree that
// the clusters are cut from.
TEST(Bvh, survives_clumps_of_spheres) {
  RayScene scene = RayScene::make(0, 5000, 5);
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    SphereRecord& sphere = scene.spheres[i];
    if (i < 1000) sphere = {{1, 2, 3}, 0.1f};
    const float shrink = i < 3000 ? 1e-5f : 1.0f;
    for (float& x : sphere.centre) x = i < 3000 ? 1000 + shrink * x : x;
  }
  expect_sound(build_bvh({}, scene.spheres), 0, 5000);
  for (auto& sphere : scene.spheres) sphere = scene.spheres[0];
  expect_sound(build_bvh({}, scene.spheres), 0, 5000);
}

TEST(Bvh, clusters_are_small_boxes) {
  const RayScene scene = RayScene::make(0, 40000, 3);
  const auto made = stages::cluster_spheres(scene.spheres);
  ASSERT_EQ(made.order.size(), scene.spheres.size());
  std::size_t next = 0;
  double sides = 0;
  for (const auto& cluster : made.clusters) {
    ASSERT_EQ(cluster.begin, next);
    ASSERT_LE(cluster.count, stages::kLargestCluster);
    next += cluster.count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float low = INFINITY, high = -INFINITY;
      for (std::size_t i = cluster.begin; i < next; ++i) {
        low = std::min(low, scene.spheres[made.order[i]].centre[axis]);
        high = std::max(high, scene.spheres[made.order[i]].centre[axis]);
      }
      sides += (high - low) / static_cast<float>(3 * made.clusters.size());
    }
  }
  EXPECT_EQ(next, scene.spheres.size());
  // 40000 in a cube of 10 m: 64 fill one of 1.2 m; cells of that octree are 0.6 or 1.25 m wide.
  EXPECT_LT(sides, 1.25);
}

// Rays test all places of a node, and of a leaf of spheres, at once: empty ones cost as much as full ones.
TEST(Bvh, nodes_and_leaves_of_spheres_are_full) {
  const Bvh bvh = build_bvh({}, RayScene::make(0, 40000, 3).spheres);
  std::size_t children = 0, leaves = 0;
  for (const BvhNode& node : bvh.nodes)
    for (const std::uint32_t child : node.child) {
      children += child != BVH_EMPTY;
      leaves += child != BVH_EMPTY && (child & BVH_LEAF) != 0;
    }
  EXPECT_GT(bvh.spheres.size(), BVH_LARGEST_LEAF * leaves * 3 / 4);
  EXPECT_GT(children, BVH_WIDTH * bvh.nodes.size() * 6 / 10);
}

// Of a subtree of three leaves, two of which lie in a node of their own if that is cheap to open.
TEST(Bvh, places_go_where_rays_cost_least) {
  using stages::PlaceChoice, stages::PlaceCosts;
  PlaceCosts leaf{}, pair{}, all{};
  leaf.fill(3);
  const PlaceChoice inner = PlaceChoice::best(leaf, leaf, 2, pair);
  EXPECT_EQ(pair[1], 8.0f);  // a node of 2 and both leaves
  for (std::size_t places = 2; places <= BVH_WIDTH; ++places) EXPECT_EQ(pair[places], 6.0f);
  EXPECT_EQ(inner.opens_from, 2);

  const PlaceChoice outer = PlaceChoice::best(leaf, pair, 10, all);
  EXPECT_EQ(all[2], 11.0f);  // the leaf, and the pair as a node
  EXPECT_EQ(all[3], 9.0f);   // all three leaves
  EXPECT_EQ(all[1], 19.0f);
  EXPECT_EQ(outer.left[2], 1);
  EXPECT_EQ(outer.left[3], 1);
  EXPECT_EQ(outer.opens_from, 2);

  // With a node that costs nothing nothing is gained by taking its parent's places.
  EXPECT_EQ(PlaceChoice::best(leaf, pair, 0, all).opens_from, BVH_WIDTH + 1);
}

TEST(Bvh, is_the_same_for_any_number_of_threads) {
  const RayScene scene = RayScene::make(3000, 100000, 7);
  const auto build = [&](std::size_t threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return build_bvh(scene.triangles, scene.spheres);
  };
  const Bvh one = build(1), many = build(4);
  EXPECT_EQ(one.root, many.root);
  EXPECT_TRUE(same_bits(one.nodes, many.nodes));
  EXPECT_TRUE(same_bits(one.triangles, many.triangles));
  EXPECT_EQ(one.sphere_source, many.sphere_source);
}

}  // namespace hybrid::testing::bvh_test
